# SPDX-License-Identifier: GPL-3.0-or-later
"""Extreme values of lights and instances: power, negative power, size, spread, and degenerate matrices."""

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
FEW_MAPS_SETTINGS = with_quality(SMALL_SHADOW_MAPS, samples=2, virtual_lights=32)
BOTH_METHODS = pytest.mark.parametrize("settings", [SETTINGS, FEW_MAPS_SETTINGS], ids=["rays", "maps"])
MESHES = [quad((-2, -2, 0), (4, 0, 0), (0, 4, 0)), random_triangles(60, 0.6)]
INSTANCE_MATRICES = [transform(), transform(offset=(0.0, 0.0, 0.9))]
LIGHT = light(position=(0.8, -0.6, 3.2), radiance=5.0)
OTHER_LIGHT = light(LightShape.ELLIPSE, (-1.0, 0.4, 2.5), radiance=3.0)
VIEW = look_at((3.0, -3.6, 2.6), size=(96, 64))


def picture(device, lights: Lights, settings: Settings = SETTINGS, world: float = 0.0) -> np.ndarray:
    return draw(device, make_scene(MESHES, lights, INSTANCE_MATRICES, world=world), VIEW, settings).color


def scaled_radiance(lights: Lights, factor: float) -> Lights:
    return replace(lights, emission=(lights.emission * np.float64(factor)).astype(np.float32))


@pytest.mark.parametrize("factor", [1e-12, 1e-6, 1e6, 1e12])
@BOTH_METHODS
def test_any_power(device, assert_within, settings, factor):
    """The picture scales with the power of the lights."""
    plain = picture(device, join_lights(LIGHT, OTHER_LIGHT), settings)
    other = picture(device, scaled_radiance(join_lights(LIGHT, OTHER_LIGHT), factor), settings)
    assert_within(relative_difference(other.astype(np.float64) / factor, plain), 1e-3)


@BOTH_METHODS
def test_a_light_of_no_power(device, assert_within, settings):
    """A light without power changes nothing."""
    dark, other = (
        picture(device, scaled_radiance(area_light, 0.0), settings, world=0.1) for area_light in (LIGHT, OTHER_LIGHT)
    )
    assert_within(relative_difference(dark, other), 0.0)
    assert_within(float(np.abs(picture(device, scaled_radiance(LIGHT, 0.0), settings)[..., :3]).max()), 0.0)


@pytest.mark.parametrize(
    "settings", [with_quality(SETTINGS, samples=64), with_quality(FEW_MAPS_SETTINGS, samples=8)], ids=["rays", "maps"]
)
def test_a_negative_light_subtracts_its_light(device, assert_within, settings):
    """Blender allows negative lights. Alone, one gives the negated picture; added to its positive, only noise."""
    plain = picture(device, LIGHT, settings)
    assert_within(relative_difference(-picture(device, scaled_radiance(LIGHT, -1.0), settings), plain), 1e-2)
    cancelled = picture(device, join_lights(LIGHT, scaled_radiance(LIGHT, -1.0)), settings)
    assert_within(float(np.sqrt((cancelled[..., :3] ** 2).mean()) / plain[..., :3].mean()), 4e-2)


def test_a_negative_light_among_others(device, assert_within):
    """The picture is the difference of the lights' own pictures."""
    settings = with_quality(SETTINGS, samples=128)
    expected = picture(device, LIGHT, settings) - picture(device, scaled_radiance(OTHER_LIGHT, 0.3), settings)
    together = picture(device, join_lights(LIGHT, scaled_radiance(OTHER_LIGHT, -0.3)), settings)
    assert_within(relative_difference(together, expected), 2e-2)


@pytest.mark.parametrize("size", [1e-9, 1e-6, 1e-3])
@BOTH_METHODS
def test_a_light_of_almost_no_size(device, assert_within, settings, size):
    """Of the same power, it illuminates as a point light does."""
    area_lights = [
        light(position=(0.8, -0.6, 3.2), axis_u=(side, 0, 0), axis_v=(0, -side, 0), radiance=5.0 / side**2)
        for side in (size, 1e-4)
    ]
    assert_within(relative_difference(*(picture(device, area_light, settings) for area_light in area_lights)), 1e-2)


@pytest.mark.parametrize("size", [1e4, 1e6])
def test_a_huge_light(device, assert_within, size):
    """It fills the floor's hemisphere, so the floor's radiance is that of the light times the base colour."""
    area_light = light(position=(0.0, 0.0, 3.2), axis_u=(size, 0, 0), axis_v=(0, -size, 0))
    floor = draw(device, make_scene(MESHES[:1], area_light), VIEW, SETTINGS)
    position = floor.target("position")
    # Pixels at the floor's edge are partly background.
    inside = (position[..., 3] > 0.0) & (np.abs(position[..., :2]).max(-1) < 1.95)
    assert_within(float(np.abs(floor.color[..., 0][inside] / 0.6 - 1.0).max()), 1e-2)


@pytest.mark.parametrize("spread", [0.0, 1e-6, 1e-3])
@BOTH_METHODS
def test_a_spread_of_almost_zero(device, assert_within, settings, spread):
    """The light is parallel: it illuminates only the area below it, and every pixel is finite."""
    area_light = light(position=(0.0, 0.0, 3.0), spread=spread)
    drawn = draw(device, make_scene(MESHES[:1], area_light), VIEW, settings)
    color, position = drawn.color, drawn.target("position")
    assert_within(float((~np.isfinite(color)).sum()), 0)
    outside = np.abs(position[..., :2]).max(-1) > 0.6
    assert_within(float(np.abs(color[..., :3][outside]).max()), 1e-6)


def test_the_widest_spread_has_no_effect(device, assert_within):
    wide = replace(LIGHT, spread=np.array([math.pi * (1.0 - 1e-6)], np.float32))
    assert_within(relative_difference(picture(device, wide), picture(device, LIGHT)), 1e-3)


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
@BOTH_METHODS
def test_any_instance_matrix(device, assert_within, settings, name):
    """An instance with this matrix looks like a mesh with the same triangles in world space."""
    original = random_triangles(60, 0.6)
    applied = replace(original, positions=(original.positions @ MATRICES[name].T).astype(np.float32))
    corners = applied.positions[applied.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    up = np.broadcast_to(np.array([0.0, 0.0, 1.0]), normal.shape)
    unit = np.where(length > 0.0, normal / np.maximum(length, 1e-30), up)
    applied = replace(applied, normals=np.repeat(unit[:, None], 3, 1).astype(np.float32))
    pictures = []
    for mesh, matrix in (
        (original, transform(MATRICES[name], (0.0, 0.0, 0.9))),
        (applied, transform(offset=(0.0, 0.0, 0.9))),
    ):
        scene = make_scene([MESHES[0], mesh], LIGHT, [transform(), matrix])
        pictures.append(draw(device, scene, VIEW, settings).color)
    assert_within(
        relative_difference(*pictures), {"rays": 5e-3, "maps": 5e-2}["rays" if settings is SETTINGS else "maps"]
    )
