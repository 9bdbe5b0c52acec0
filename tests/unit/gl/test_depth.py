# SPDX-License-Identifier: GPL-3.0-or-later
"""Depth from near to far: 1 to 0, and as fine far off as nearby."""

import numpy as np
import pytest

from ism_addon.gpu.gl.depth import logarithm, nearness
from tests.support.small_scenes import perspective, view_from_above

WAYS = {nearness: lambda x, y, w: x / w + y, logarithm: lambda x, y, w: x + y * np.log2(w)}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(("near", "far"), [(0.01, 1000.0), (0.5, 2.0), (1e-3, 1e30)])
def test_the_nearer_the_more(way, near, far):
    depth, distances = way(perspective(1.0, 1.5, near, far)), np.geomspace(near, min(far, 1e9), 1000)
    found = WAYS[way](*depth, distances)
    assert (np.diff(found) < 0.0).all()
    assert found[0] == pytest.approx(1.0, abs=1e-6)
    assert found[-1] >= -1e-6
    if far < 1e9:
        assert found[-1] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("way", WAYS)
def test_float32_tells_apart_what_is_a_hundred_thousandth_farther(way):
    depth, distances = way(perspective(1.0, 1.5, 0.01, 1000.0)), np.geomspace(0.01, 990.0, 1000)
    here, farther = (
        np.float32(WAYS[way](*map(np.float32, depth), w.astype("f4"))) for w in (distances, distances * 1.00001)
    )
    assert (farther < here).all()


@pytest.mark.parametrize("way", WAYS)
def test_an_orthographic_view_has_linear_depth(way):
    assert way(view_from_above(1.0).clip_from_view) == (0.0, 0.0)
