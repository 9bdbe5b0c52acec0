# SPDX-License-Identifier: GPL-3.0-or-later
"""Retests find the lights that arrive where all rays had said that they do not, each of them, and no others."""

import numpy as np
import pytest

from ism_addon.gpu.passes.light_selection.retest_occluded import RetestOccluded
from ism_addon.resources import REDISCOVERED
from ism_addon.scene import LightShape
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    draw,
    join_lights,
    light,
    make_scene,
    quad,
    view_from_above,
    with_quality,
)

FLOOR = quad((-2, -2, 0), (4, 0, 0), (0, 4, 0))
#: Below the second light, and all that it can light.
PLATE = quad((-9, -9, 3.9), (18, 0, 0), (0, 18, 0))


@pytest.fixture
def all_believed_occluded(monkeypatch):
    """Every light in every tile is retested in each sample."""

    def candidates(frame) -> tuple[np.ndarray, np.ndarray]:
        lights, (columns, rows) = np.arange(len(frame.scene.lights.shape)), frame.tiles
        return lights, np.cumsum(np.ones(len(lights) * columns * rows))

    monkeypatch.setattr(RetestOccluded, "candidates", staticmethod(candidates))


@pytest.mark.parametrize("size", [(32, 32), (20, 44)])
def test_of_lights_in_one_tile_each_is_told(device, all_believed_occluded, size):
    lights = join_lights(light(), join_lights(light(position=(0, 0, 4)), light(LightShape.ELLIPSE, (0.5, 0.2, 2.0))))
    view, settings = view_from_above(2.0, size, 3.0), with_quality(SMALL_SETTINGS, samples=5)
    drawn = draw(device, make_scene([FLOOR, PLATE], lights), view, settings)
    found = drawn.renderer.graph[REDISCOVERED]
    assert set(found) == {0, 2}, "the plate hides the second"
    assert all(tiles.all() for tiles in found.values())


def test_a_light_is_found_in_the_tiles_that_it_reaches(device, all_believed_occluded):
    """A wall between the light, to the left, and what is right of it."""
    wall = quad((0.0, -3, 0), (0, 6, 0), (0, 0, 9))
    lights = light(position=(-0.5, 0, 2), axis_u=(0.2, 0, 0), axis_v=(0, -0.2, 0))
    view = view_from_above(2.0, (64, 32))
    drawn = draw(device, make_scene([FLOOR, wall], lights), view, with_quality(SMALL_SETTINGS, samples=5))
    (found,) = drawn.renderer.graph[REDISCOVERED].values()
    assert found[:, :4].all() and not found[:, 4:].any()
    assert drawn.profile.counts["retests"] == 4 * found.size * 16, "in four samples, 16 rays a tile"
