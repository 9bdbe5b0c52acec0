# SPDX-License-Identifier: GPL-3.0-or-later
"""Retests find exactly those lights that are visible in a tile although all its rays were occluded before."""

import numpy as np
import pytest

from ism_addon.gpu.culling.hidden_lights import COARSE_SIDE, coarse_tiles_of
from ism_addon.gpu.passes.light_selection.retest_occluded import RetestOccluded
from ism_addon.gpu.passes.light_selection.retests import Candidates
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
#: Below the second light, so that it occludes all that this light could reach.
PLATE = quad((-9, -9, 3.9), (18, 0, 0), (0, 18, 0))


@pytest.fixture
def all_believed_occluded(monkeypatch):
    """Every light in every tile is retested in each sample."""

    def candidates(frame) -> Candidates:
        lights, (columns, rows) = np.arange(len(frame.scene.lights.shape)), frame.tiles
        return Candidates(lights, np.zeros(0, int), np.cumsum(np.ones(len(lights) * columns * rows)))

    monkeypatch.setattr(RetestOccluded, "candidates", staticmethod(candidates))


@pytest.mark.parametrize("size", [(32, 32), (20, 44)])
def test_every_visible_light_of_a_tile_is_rediscovered(device, all_believed_occluded, size):
    lights = join_lights(light(), join_lights(light(position=(0, 0, 4)), light(LightShape.ELLIPSE, (0.5, 0.2, 2.0))))
    view, settings = view_from_above(2.0, size, 3.0), with_quality(SMALL_SETTINGS, samples=5)
    drawn = draw(device, make_scene([FLOOR, PLATE], lights), view, settings)
    rediscovered = drawn.renderer.graph[REDISCOVERED]
    assert set(rediscovered) == {0, 2}, "the plate occludes the second"
    assert all(tiles.all() for tiles in rediscovered.values())


def test_a_light_is_rediscovered_in_the_tiles_that_it_reaches(device, all_believed_occluded):
    """A wall stands between the light, on the left, and the right half of the floor."""
    wall = quad((0.0, -3, 0), (0, 6, 0), (0, 0, 9))
    lights = light(position=(-0.5, 0, 2), axis_u=(0.2, 0, 0), axis_v=(0, -0.2, 0))
    view = view_from_above(2.0, (64, 32))
    drawn = draw(device, make_scene([FLOOR, wall], lights), view, with_quality(SMALL_SETTINGS, samples=5))
    (tiles,) = drawn.renderer.graph[REDISCOVERED].values()
    assert tiles[:, :4].all() and not tiles[:, 4:].any()
    assert drawn.profile.counts["retests"] == 4 * tiles.size * 16, "in four samples, 16 rays a tile"


def test_hidden_lights_are_retested_in_all_of_their_coarse_tiles(device, monkeypatch):
    """Twenty-five coarse tiles of up to sixteen tiles: a light that no ray can reach, and one that any ray reaches."""

    def candidates(frame) -> Candidates:
        columns, rows = coarse_tiles_of(frame.tiles)
        return Candidates(np.zeros(0, int), np.arange(2), np.cumsum(np.full(2 * columns * rows, COARSE_SIDE**2)))

    monkeypatch.setattr(RetestOccluded, "candidates", staticmethod(candidates))
    scene = make_scene([FLOOR, PLATE], join_lights(light(), light(position=(0, 0, 4))))
    drawn = draw(device, scene, view_from_above(2.0, (150, 140), 3.0), with_quality(SMALL_SETTINGS, samples=5))
    rediscovered = drawn.renderer.graph[REDISCOVERED]
    assert set(rediscovered) == {0}
    assert rediscovered[0].shape == (18, 19) and rediscovered[0].all()
