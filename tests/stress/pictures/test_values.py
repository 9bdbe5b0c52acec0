# SPDX-License-Identifier: GPL-3.0-or-later
"""Values at their ends: lights of hardly any power or far too much, negative ones, of no size, straight ahead."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.scene import Lights, LightShape
from ism_addon.settings import SSAO, Quality, Settings
from tests.stress.pictures.comparisons import relative_difference
from tests.support.small_scenes import (
    SMALL_SHADOW_MAPS,
    draw,
    join_lights,
    light,
    look_at,
    make_scene,
    quad,
    random_triangles,
    transform,
    with_quality,
)

SETTINGS = Settings(ssao=SSAO(enabled=False), quality=Quality(samples=16, error_threshold=0.0))
SMALL_MAPS = with_quality(SMALL_SHADOW_MAPS, samples=2, virtual_lights=32)
BOTH = pytest.mark.parametrize("settings", [SETTINGS, SMALL_MAPS], ids=["rays", "maps"])
THINGS = [quad((-2, -2, 0), (4, 0, 0), (0, 4, 0)), random_triangles(60, 0.6)]
PLACES = [transform(), transform(offset=(0.0, 0.0, 0.9))]
LAMP = light(position=(0.8, -0.6, 3.2), radiance=5.0)
OTHER = light(LightShape.ELLIPSE, (-1.0, 0.4, 2.5), radiance=3.0)
VIEW = look_at((3.0, -3.6, 2.6), size=(96, 64))


def picture(device, lights: Lights, settings: Settings = SETTINGS, world: float = 0.0) -> np.ndarray:
    return draw(device, make_scene(THINGS, lights, PLACES, world=world), VIEW, settings).color


def times(lights: Lights, factor: float) -> Lights:
    return replace(lights, radiance=(lights.radiance * np.float64(factor)).astype(np.float32))


@pytest.mark.parametrize("factor", [1e-12, 1e-6, 1e6, 1e12])
@BOTH
def test_any_power(device, within, settings, factor):
    """As much brighter as the lights are."""
    plain = picture(device, join_lights(LAMP, OTHER), settings)
    other = picture(device, times(join_lights(LAMP, OTHER), factor), settings).astype(np.float64) / factor
    within(relative_difference(other, plain), 1e-3)


@BOTH
def test_a_light_of_no_power(device, within, settings):
    """As without it."""
    dark, other = (picture(device, times(lamp, 0.0), settings, world=0.1) for lamp in (LAMP, OTHER))
    within(relative_difference(dark, other), 0.0)
    within(float(np.abs(picture(device, times(LAMP, 0.0), settings)[..., :3]).max()), 0.0)


@pytest.mark.parametrize(
    "settings", [with_quality(SETTINGS, samples=64), with_quality(SMALL_MAPS, samples=8)], ids=["rays", "maps"]
)
def test_a_negative_light_takes_away_what_it_would_give(device, within, settings):
    """Blender allows it: with the same light of as much power nothing is left but noise; alone it is the negative."""
    plain = picture(device, LAMP, settings)
    within(relative_difference(-picture(device, times(LAMP, -1.0), settings), plain), 1e-2)
    nothing = picture(device, join_lights(LAMP, times(LAMP, -1.0)), settings)
    within(float(np.sqrt((nothing[..., :3] ** 2).mean()) / plain[..., :3].mean()), 4e-2)


def test_a_negative_light_among_others(device, within):
    """What is left is the difference of their pictures."""
    settings = with_quality(SETTINGS, samples=128)
    apart_from_it = picture(device, LAMP, settings) - picture(device, times(OTHER, 0.3), settings)
    together = picture(device, join_lights(LAMP, times(OTHER, -0.3)), settings)
    within(relative_difference(together, apart_from_it), 2e-2)


@pytest.mark.parametrize("size", [1e-9, 1e-6, 1e-3])
@BOTH
def test_a_light_of_next_to_no_size(device, within, settings, size):
    """Of the same power, it is a point."""
    lamps = [
        light(position=(0.8, -0.6, 3.2), axis_u=(side, 0, 0), axis_v=(0, -side, 0), radiance=5.0 / side**2)
        for side in (size, 1e-4)
    ]
    within(relative_difference(*(picture(device, lamp, settings) for lamp in lamps)), 1e-2)


@pytest.mark.parametrize("size", [1e4, 1e6])
def test_a_light_without_end(device, within, size):
    """A sky: of half of all directions what it sends is what is received."""
    lamp = light(position=(0.0, 0.0, 3.2), axis_u=(size, 0, 0), axis_v=(0, -size, 0))
    floor = draw(device, make_scene(THINGS[:1], lamp), VIEW, SETTINGS)
    position = floor.target("position")
    seen = (position[..., 3] > 0.0) & (np.abs(position[..., :2]).max(-1) < 1.95)  # not at the floor's edge
    within(float(np.abs(floor.color[..., 0][seen] / 0.6 - 1.0).max()), 1e-2)


@pytest.mark.parametrize("spread", [0.0, 1e-6, 1e-3])
@BOTH
def test_a_spread_of_nothing(device, within, settings, spread):
    """It shines straight ahead: under it lies its image, with its own edges, and everything is finite."""
    lamp = light(position=(0.0, 0.0, 3.0), spread=spread)
    drawn = draw(device, make_scene(THINGS[:1], lamp), VIEW, settings)
    color, position = drawn.color, drawn.target("position")
    within(float((~np.isfinite(color)).sum()), 0)
    outside = np.abs(position[..., :2]).max(-1) > 0.6
    within(float(np.abs(color[..., :3][outside]).max()), 1e-6)


def test_the_widest_spread_is_none(device, within):
    wide = replace(LAMP, spread=np.array([math.pi * (1.0 - 1e-6)], np.float32))
    within(relative_difference(picture(device, wide), picture(device, LAMP)), 1e-3)


MATRICES = {
    "zero": np.zeros((3, 3)),
    "flat": np.diag([1.0, 1.0, 0.0]),
    "a line": np.diag([1.0, 0.0, 0.0]),
    "negative": np.diag([-1.0, -1.0, -1.0]),
    "sheared": np.array([[1.0, 5.0, 0.0], [0.0, 1.0, 0.0], [0.0, 3.0, 1.0]]),
    "uneven": np.diag([1e-2, 1.0, 1e2]),
    "tiny": 1e-9 * np.eye(3),
}


@pytest.mark.parametrize("name", MATRICES)
@BOTH
def test_scales_of_all_kinds(device, within, settings, name):
    """The same as its triangles where they then stand, as a mesh of their own."""
    thing = random_triangles(60, 0.6)
    there = replace(thing, positions=(thing.positions @ MATRICES[name].T).astype(np.float32))
    edges = there.positions[there.triangles]
    normal = np.cross(edges[:, 1] - edges[:, 0], edges[:, 2] - edges[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    up = np.broadcast_to(np.array([0.0, 0.0, 1.0]), normal.shape)
    unit = np.where(length > 0.0, normal / np.maximum(length, 1e-30), up)
    there = replace(there, normals=np.repeat(unit[:, None], 3, 1).astype(np.float32))
    pictures = []
    for mesh, matrix in (
        (thing, transform(MATRICES[name], (0.0, 0.0, 0.9))),
        (there, transform(offset=(0.0, 0.0, 0.9))),
    ):
        scene = make_scene([THINGS[0], mesh], LAMP, [transform(), matrix])
        pictures.append(draw(device, scene, VIEW, settings).color)
    within(relative_difference(*pictures), {"rays": 5e-3, "maps": 5e-2}["rays" if settings is SETTINGS else "maps"])
