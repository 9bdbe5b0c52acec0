# SPDX-License-Identifier: GPL-3.0-or-later
"""Depth values: 1 at the near plane to 0 at the far plane, with float32 precision at all distances."""

import numpy as np
import pytest

from ism_addon.gpu.gl.depth import logarithm, nearness
from tests.support.small_scenes import perspective, view_from_above

#: Each depth function, and how depth follows from its two terms and the distance.
MAPPINGS = {nearness: lambda x, y, w: x / w + y, logarithm: lambda x, y, w: x + y * np.log2(w)}


@pytest.mark.parametrize("mapping", MAPPINGS)
@pytest.mark.parametrize(("near", "far"), [(0.01, 1000.0), (0.5, 2.0), (1e-3, 1e30)])
def test_depth_falls_with_distance(mapping, near, far):
    terms, distances = mapping(perspective(1.0, 1.5, near, far)), np.geomspace(near, min(far, 1e9), 1000)
    depths = MAPPINGS[mapping](*terms, distances)
    assert (np.diff(depths) < 0.0).all()
    assert depths[0] == pytest.approx(1.0, abs=1e-6)
    assert depths[-1] >= -1e-6
    if far < 1e9:
        assert depths[-1] == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("mapping", MAPPINGS)
def test_float32_separates_distances_that_differ_by_a_hundred_thousandth(mapping):
    terms, distances = mapping(perspective(1.0, 1.5, 0.01, 1000.0)), np.geomspace(0.01, 990.0, 1000)
    here, farther = (
        np.float32(MAPPINGS[mapping](*map(np.float32, terms), w.astype("f4"))) for w in (distances, distances * 1.00001)
    )
    assert (farther < here).all()


@pytest.mark.parametrize("mapping", MAPPINGS)
def test_an_orthographic_view_has_linear_depth(mapping):
    assert mapping(view_from_above(1.0).clip_from_view) == (0.0, 0.0)
