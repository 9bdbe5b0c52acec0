# SPDX-License-Identifier: GPL-3.0-or-later
"""Targets with a texel for each block, in strips."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ism_addon.gpu.frame import TILE_SIZE, from_tile_layout
from ism_addon.gpu.gl import render_targets
from ism_addon.gpu.gl.render_targets import MAX_STRIP_HEIGHT, TILE_STRIP_WIDTH, Target
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import SMALL_SETTINGS, draw, with_quality

OF_BLOCKS = Target(1, "f4", divisor=TILE_SIZE, strips=True)

#: Of the largest picture that any OpenGL of this engine's can draw.
LARGEST = 32768

SIDES = st.integers(1, LARGEST)


@given(width=SIDES, height=SIDES)
def test_strips_hold_all_blocks_and_are_no_longer_than_textures_may_be(width, height):
    across, along = OF_BLOCKS.size(width, height)
    columns, rows = Target(1, "f4", divisor=TILE_SIZE).size(width, height)
    assert max(across, along) <= MAX_STRIP_HEIGHT
    assert 0 <= across * along - columns * rows < max(2 * across, 3 * TILE_STRIP_WIDTH), (
        "a row more where that is no power of two"
    )
    assert all(side & (side - 1) for side in (across, along)), "drivers would compile once more"


def test_blocks_lie_in_strips_row_by_row():
    blocks = 5, 7
    across, along = OF_BLOCKS.size(*(TILE_SIZE * count for count in blocks))
    texels = np.arange(across * along).reshape(along, across, 1)
    assert np.array_equal(from_tile_layout(texels, blocks)[..., 0], np.arange(35).reshape(7, 5))


@pytest.mark.parametrize("longest", [1, 3])
def test_the_picture_does_not_depend_on_how_long_strips_are(device, monkeypatch, longest):
    scene, view = box_over_plane(100, 60)
    settings = with_quality(SMALL_SETTINGS, samples=6)
    expected = draw(device, scene, view, settings)
    monkeypatch.setattr(render_targets, "MAX_STRIP_HEIGHT", longest)
    found = draw(device, scene, view, settings)
    assert np.array_equal(found.color, expected.color)
    assert np.array_equal(found.renderer.error.variance, expected.renderer.error.variance)
