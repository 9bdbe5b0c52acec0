# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures against closed forms: unshadowed light, a half-plane, ambient occlusion in a corner, a white furnace."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.choices import OcclusionSampling
from ism_addon.scene import Lights
from ism_addon.settings import SSAO
from tests.scenes.small import SMALL
from tests.support import reference_irradiance
from tests.support.small_scenes import (
    AREA_SHAPES,
    SMALL_SETTINGS,
    SMALL_SHADOW_MAPS,
    draw,
    light,
    make_scene,
    quad,
    view_from_above,
    with_quality,
)
from tests.unit.occlusion.test_ambient_occlusion import (
    HEMISPHERE_SSAO,
    corner,
    half_resolution_surface,
    mean_occlusion,
)

FLOOR = quad((-50, -50, 0), (100, 0, 0), (0, 100, 0))
#: Radiance over irradiance of the floor, whose base colour is 0.6.
BRDF = 0.6 / math.pi
UP = np.array([0.0, 0.0, 1.0])


def pixel_positions(width: float, pixels: int) -> np.ndarray:
    """(pixels,) m: x of the pixel centres of a picture from above, `width` m wide."""
    return ((np.arange(pixels) + 0.5) / pixels - 0.5) * width


@pytest.mark.parametrize("shape", AREA_SHAPES, ids=["rectangle", "ellipse"])
@pytest.mark.parametrize("size", [1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6])
def test_irradiance_of_a_floor(device, assert_within, shape, size):
    """A floor 1 m below a light of this size, from almost a point to almost a whole sky."""
    area_light = light(shape, (0.0, 0.0, 1.0), (size, 0, 0), (0, -0.7 * size, 0), radiance=1.0 / min(size**2, 1.0))
    picture = draw(device, make_scene([FLOOR], area_light), view_from_above(4.0, (9, 1))).color[0, :, 0]
    points = np.column_stack([pixel_positions(4.0, 9), np.zeros((9, 2))])
    truth = [
        BRDF * area_light.emission[0, 0] * reference_irradiance.irradiance(point, UP, area_light) for point in points
    ]
    assert_within(float(np.abs(picture / truth - 1.0).max()), 1e-3)


@pytest.mark.parametrize("height", [1e-6, 1e-4, 1e-2])
def test_a_light_that_almost_touches_the_floor(device, assert_within, height):
    """Points under a light at this height: it fills almost the whole hemisphere."""
    area_light = light(position=(0.0, 0.0, height))
    picture = draw(device, make_scene([FLOOR], area_light), view_from_above(0.8, (9, 1))).color[0, :, 0]
    points = np.column_stack([pixel_positions(0.8, 9), np.zeros((9, 2))])
    truth = [BRDF * reference_irradiance.irradiance(point, UP, area_light) for point in points]
    assert_within(float(np.abs(picture / truth - 1.0).max()), 1e-3)


def visible_strip(area_light: Lights, fraction: float) -> Lights:
    """The strip of a rectangular light towards +u that has this fraction of its width."""
    offset = 0.5 * (1.0 - fraction) * area_light.axis_u
    return replace(area_light, position=area_light.position + offset, axis_u=fraction * area_light.axis_u)


@pytest.mark.parametrize(
    ("settings", "bound"),
    [
        (with_quality(SMALL_SETTINGS, samples=256), 5e-3),
        (with_quality(SMALL_SHADOW_MAPS, samples=8, virtual_lights=32, map_size=128, map_points=1 << 15), 5e-2),
    ],
    ids=["rays", "maps"],
)
def test_the_penumbra_of_a_half_plane(device, assert_within, settings, bound):
    """A half-plane midway between floor and light: the visible fraction of the light grows linearly with x."""
    area_light = light(position=(0.0, 0.0, 2.0))
    plane = quad((-4, -4, 1), (4, 0, 0), (0, 8, 0))
    scene = make_scene([quad((-2, -2, 0), (4, 0, 0), (0, 4, 0)), plane], area_light)
    scene = replace(scene, instances=replace(scene.instances, visible=np.array([True, False])))
    picture = draw(device, scene, view_from_above(1.6, (48, 8)), settings).color[..., 0]
    truth = np.zeros((8, 48))
    for row, column in np.ndindex(truth.shape):
        x, y = pixel_positions(1.6, 48)[column], pixel_positions(1.6 / 6.0, 8)[row]
        if (fraction := float(np.clip(x + 0.5, 0.0, 1.0))) > 0.0:
            strip = visible_strip(area_light, fraction)
            truth[row, column] = BRDF * reference_irradiance.irradiance(np.array([x, y, 0.0]), UP, strip)
    assert_within(float(np.sqrt(((picture - truth) ** 2).mean()) / truth.mean()), bound)


#: Sample counts after which the error of a penumbra is checked.
def occluded_by_wall(distance: np.ndarray, radius: float) -> np.ndarray:
    """Occluded fraction of the points of ambient occlusion at points `distance` m from an infinite, perpendicular wall.

    The component c of a sample's direction along the wall's normal has the density 2/pi sqrt(1-c²). A sample at the
    distance s is behind the wall if c s > distance, and s² is uniform up to radius².
    """
    c = (np.arange(20_000) + 0.5) / 20_000
    fraction = np.maximum(1.0 - (distance[:, None] / (radius * c)) ** 2, 0.0)
    return (2.0 / np.pi * np.sqrt(1.0 - c**2) * fraction).mean(1)


def test_ambient_occlusion_in_a_corner(device, assert_within):
    scene, view = corner()
    measured = mean_occlusion(device, scene, view, replace(HEMISPHERE_SSAO, sampling=OcclusionSampling.POINTS))
    surface, rows = half_resolution_surface(scene, view)
    position = surface.position[rows]
    distance = np.where(position[..., 2] < 1e-6, -position[..., 1], position[..., 2])
    near = (distance < 0.6) & (distance > 0.03)
    error = measured[near] - (1.0 - occluded_by_wall(distance[near], 0.5))
    assert near.sum() > 500
    assert_within(abs(float(error.mean())), 0.015)
    assert_within(float(np.sqrt((error**2).mean())), 0.05)
    assert_within(float(np.abs(measured[distance > 0.6] - 1.0).max()), 1e-3)


@pytest.mark.parametrize("name", SMALL)
@pytest.mark.parametrize("ssao", [SSAO(enabled=False), SSAO()], ids=["without", "with"])
def test_white_furnace(device, assert_within, name, ssao):
    """White meshes under a white world are as bright as the world; ambient occlusion may only darken."""
    scene, view = SMALL[name](96, 64)
    white = replace(
        make_scene(scene.meshes, world=1.0, base_color=(1.0, 1.0, 1.0)),
        instances=scene.instances,
    )
    picture = draw(device, white, view, replace(SMALL_SETTINGS, ssao=ssao)).color[..., :3]
    assert_within(float((picture - 1.0).max()), 1e-5)
    if not ssao.enabled:
        assert_within(float((1.0 - picture).max()), 1e-5)


@pytest.mark.parametrize("name", SMALL)
@pytest.mark.parametrize("samples", [1, 2, 16, 64])
def test_shadows_add_no_light(device, assert_within, name, samples):
    """No pixel is brighter than with the same samples and no shadows; the bound is relative to the unshadowed mean."""
    scene, view = SMALL[name](96, 64)
    settings = replace(with_quality(SMALL_SETTINGS, samples=samples), shortcuts=False)
    unshadowed = draw(device, scene, view, replace(settings, shadow=replace(settings.shadow, enabled=False))).color
    shadowed = draw(device, scene, view, settings).color
    assert_within(float((shadowed - unshadowed)[..., :3].max() / unshadowed[..., :3].mean()), 1e-5)
