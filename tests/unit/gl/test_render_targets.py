# SPDX-License-Identifier: GPL-3.0-or-later
"""Targets with one texel per tile, laid out in strips."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ism_addon.gpu.gl import render_targets
from ism_addon.gpu.gl.render_targets import MAX_STRIP_HEIGHT, TILE_STRIP_WIDTH, size_of
from ism_addon.gpu.tiles import from_strips
from ism_addon.resource_types import Target
from ism_addon.resources import TILE_SIZE
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import SMALL_SETTINGS, draw, with_quality

IN_STRIPS = Target("in_strips", "", divisor=TILE_SIZE, strips=True)

#: Side of the largest picture that any supported OpenGL can draw.
MAX_PICTURE_SIDE = 32768

SIDES = st.integers(1, MAX_PICTURE_SIDE)


@given(width=SIDES, height=SIDES)
def test_strips_hold_all_tiles_and_fit_the_texture_limit(width, height):
    across, along = size_of(IN_STRIPS, width, height)
    columns, rows = size_of(Target("in_rows", "", divisor=TILE_SIZE), width, height)
    assert max(across, along) <= MAX_STRIP_HEIGHT
    assert 0 <= across * along - columns * rows < max(2 * across, 3 * TILE_STRIP_WIDTH), (
        "one more row avoids a power of two"
    )
    assert all(side & (side - 1) for side in (across, along)), "drivers would compile shaders again"


def test_tiles_lie_in_strips_row_by_row():
    tiles = 5, 7
    across, along = size_of(IN_STRIPS, *(TILE_SIZE * count for count in tiles))
    texels = np.arange(across * along).reshape(along, across, 1)
    assert np.array_equal(from_strips(texels, tiles)[..., 0], np.arange(35).reshape(7, 5))


@pytest.mark.parametrize("max_height", [1, 3])
def test_the_picture_does_not_depend_on_how_long_strips_are(device, monkeypatch, max_height):
    scene, view = box_over_plane(100, 60)
    settings = with_quality(SMALL_SETTINGS, samples=6)
    expected = draw(device, scene, view, settings)
    monkeypatch.setattr(render_targets, "MAX_STRIP_HEIGHT", max_height)
    short = draw(device, scene, view, settings)
    assert np.array_equal(short.color, expected.color)
    assert np.array_equal(short.renderer.error.variance, expected.renderer.error.variance)
