# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of what can be calculated: the light on a floor, a penumbra, a corner, a room that is white all over."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.scene import Lights, LightShape
from ism_addon.settings import SSAO
from tests.scenes.small import SMALL
from tests.support import reference_irradiance
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    SMALL_SHADOW_MAPS,
    draw,
    light,
    make_scene,
    quad,
    view_from_above,
    with_quality,
)
from tests.unit.environment.test_ambient_occlusion import FULL, corner, half_resolution_surface, mean_occlusion

FLOOR = quad((-50, -50, 0), (100, 0, 0), (0, 100, 0))
#: Of the floor: what arrives becomes this part of radiance.
REFLECTED = 0.6 / math.pi
UP = np.array([0.0, 0.0, 1.0])


def places(width: float, pixels: int) -> np.ndarray:
    """(pixels,) m: where the columns of a picture from above look."""
    return ((np.arange(pixels) + 0.5) / pixels - 0.5) * width


@pytest.mark.parametrize("shape", list(LightShape), ids=["rectangle", "ellipse"])
@pytest.mark.parametrize("size", [1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6])
def test_light_on_a_floor(device, within, shape, size):
    """Of a light so large, a metre above it: from next to nothing to touching all of it."""
    lamp = light(shape, (0.0, 0.0, 1.0), (size, 0, 0), (0, -0.7 * size, 0), radiance=1.0 / min(size**2, 1.0))
    picture = draw(device, make_scene([FLOOR], lamp), view_from_above(4.0, (9, 1))).color[0, :, 0]
    points = np.column_stack([places(4.0, 9), np.zeros((9, 2))])
    truth = [REFLECTED * lamp.radiance[0, 0] * reference_irradiance.irradiance(point, UP, lamp) for point in points]
    within(float(np.abs(picture / truth - 1.0).max()), 1e-3)


@pytest.mark.parametrize("height", [1e-6, 1e-4, 1e-2])
def test_a_light_that_almost_touches(device, within, height):
    """Half a sky of light, below its middle, from a hair's breadth."""
    lamp = light(position=(0.0, 0.0, height))
    picture = draw(device, make_scene([FLOOR], lamp), view_from_above(0.8, (9, 1))).color[0, :, 0]
    points = np.column_stack([places(0.8, 9), np.zeros((9, 2))])
    truth = [REFLECTED * reference_irradiance.irradiance(point, UP, lamp) for point in points]
    within(float(np.abs(picture / truth - 1.0).max()), 1e-3)


def strip(lamp: Lights, part: float) -> Lights:
    """The part of a light that is on the side of its axis u."""
    return replace(lamp, position=lamp.position + 0.5 * (1.0 - part) * lamp.axis_u, axis_u=part * lamp.axis_u)


@pytest.mark.parametrize(
    ("settings", "bound"),
    [
        (with_quality(SMALL_SETTINGS, samples=256), 5e-3),
        (with_quality(SMALL_SHADOW_MAPS, samples=8, virtual_lights=32, map_size=128, map_points=1 << 15), 5e-2),
    ],
    ids=["rays", "maps"],
)
def test_the_penumbra_of_a_half_plane(device, within, settings, bound):
    """Halfway between the floor and the light: of the light, as much is hidden as the receiver is below the plane."""
    lamp = light(position=(0.0, 0.0, 2.0))
    plane = quad((-4, -4, 1), (4, 0, 0), (0, 8, 0))
    scene = make_scene([quad((-2, -2, 0), (4, 0, 0), (0, 4, 0)), plane], lamp)
    scene = replace(scene, instances=replace(scene.instances, visible=np.array([True, False])))
    picture = draw(device, scene, view_from_above(1.6, (48, 8)), settings).color[..., 0]
    truth = np.zeros((8, 48))
    for row, column in np.ndindex(truth.shape):
        x, y = places(1.6, 48)[column], places(1.6 / 6.0, 8)[row]
        if (part := float(np.clip(x + 0.5, 0.0, 1.0))) > 0.0:
            arrives = reference_irradiance.irradiance(np.array([x, y, 0.0]), UP, strip(lamp, part))
            truth[row, column] = REFLECTED * arrives
    within(float(np.sqrt(((picture - truth) ** 2).mean()) / truth.mean()), bound)


#: Numbers of samples at which a penumbra is looked at.
COUNTS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 64, 96, 128, 256, 512, 1024, 2048)


def part_before_an_edge(x: float, y: float, edge: np.ndarray) -> float:
    """Irradiance at (x, y, 0) by the part of a square light 2 m up that is seen past an edge 1 m over the origin."""
    corners = [np.array(corner) for corner in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))]
    ahead, seen = [corner @ edge + edge @ (x, y) for corner in corners], []
    for k in range(4):
        if ahead[k] >= 0.0:
            seen.append(corners[k])
        if (ahead[k] >= 0.0) != (ahead[k - 3] >= 0.0):
            seen.append(corners[k] + (corners[k - 3] - corners[k]) * ahead[k] / (ahead[k] - ahead[k - 3]))
    polygon = np.array([(*(corner - (x, y)), 2.0) for corner in seen])
    return abs(reference_irradiance.edge_sum(polygon, UP)) if len(seen) > 2 else 0.0


@pytest.mark.parametrize("degrees", [0, 33, 90])
def test_penumbrae_have_no_floor(device, within, degrees):
    """Beside an edge at any angle the error falls as a randomised sequence's does, and no bias is left."""
    angle, size = math.radians(degrees), (48, 48)
    edge, along = np.array([math.cos(angle), math.sin(angle), 0.0]), np.array([-math.sin(angle), math.cos(angle), 0.0])
    plate = quad(np.array([0.0, 0.0, 1.0]) - 4.0 * edge - 4.0 * along, 4.0 * edge, 8.0 * along)
    scene = make_scene([quad((-2, -2, 0), (4, 0, 0), (0, 4, 0)), plate], light())
    scene = replace(scene, instances=replace(scene.instances, visible=np.array([True, False])))
    view, axis = view_from_above(1.0, size, filter_width=1.5), places(1.0, 48)
    whole = reference_irradiance.irradiance(np.zeros(3), UP, light())
    truth = np.array([[part_before_an_edge(x, y, edge[:2]) for x in axis] for y in axis]) / whole
    penumbra = (truth > 0.02) & (truth < 0.98)
    renderer, profile, settings = Renderer(device), Profile(), with_quality(SMALL_SETTINGS, samples=COUNTS[-1])
    for sample in range(COUNTS[-1]):
        for _ in renderer.sample(scene, view, settings, sample, profile):
            pass
        if sample + 1 in COUNTS:
            off = (renderer.picture()[..., 0] / (REFLECTED * whole) - truth)[penumbra]
            within(float(np.sqrt((off**2).mean())) * (sample + 1) ** 0.65, 0.2)
    within(float(np.sqrt((off**2).mean())), 0.0016)
    within(abs(float(off.mean())), 0.0003)


def hidden_before_a_wall(distance: np.ndarray, radius: float) -> np.ndarray:
    """The hidden part of the hemisphere's places, `distance` m before an endless wall at a right angle.

    The component c along the wall's normal has the density 2/pi sqrt(1-c²); a place at the distance s is within the
    wall if c s > distance, and s² is even up to radius².
    """
    c = (np.arange(20_000) + 0.5) / 20_000
    part = np.maximum(1.0 - (distance[:, None] / (radius * c)) ** 2, 0.0)
    return (2.0 / np.pi * np.sqrt(1.0 - c**2) * part).mean(1)


def test_ambient_occlusion_in_a_corner(device, within):
    scene, view = corner()
    ours = mean_occlusion(device, scene, view, FULL)
    surface, rows = half_resolution_surface(scene, view)
    position = surface.position[rows]
    distance = np.where(position[..., 2] < 1e-6, -position[..., 1], position[..., 2])
    near = (distance < 0.6) & (distance > 0.03)
    off = ours[near] - (1.0 - hidden_before_a_wall(distance[near], 0.5))
    assert near.sum() > 500
    within(abs(float(off.mean())), 0.015)
    within(float(np.sqrt((off**2).mean())), 0.05)
    within(float(np.abs(ours[distance > 0.6] - 1.0).max()), 1e-3)


@pytest.mark.parametrize("name", SMALL)
@pytest.mark.parametrize("ssao", [SSAO(enabled=False), SSAO()], ids=["without", "with"])
def test_a_furnace(device, within, name, ssao):
    """White things under a white sky cannot be told from it; ambient occlusion may only darken."""
    scene, view = SMALL[name](96, 64)
    white = replace(
        make_scene(scene.meshes, world=1.0, base_color=(1.0, 1.0, 1.0)),
        instances=scene.instances,
    )
    picture = draw(device, white, view, replace(SMALL_SETTINGS, ssao=ssao)).color[..., :3]
    within(float((picture - 1.0).max()), 1e-5)
    if not ssao.enabled:
        within(float((1.0 - picture).max()), 1e-5)


@pytest.mark.parametrize("name", SMALL)
@pytest.mark.parametrize("samples", [1, 2, 16, 64])
def test_shadows_add_no_light(device, within, name, samples):
    """No pixel is brighter than without shadows, over the picture's mean, if as many samples are drawn of it."""
    scene, view = SMALL[name](96, 64)
    settings = replace(with_quality(SMALL_SETTINGS, samples=samples), shortcuts=False)
    whole = draw(device, scene, view, replace(settings, shadow=replace(settings.shadow, enabled=False))).color
    shaded = draw(device, scene, view, settings).color
    within(float((shaded - whole)[..., :3].max() / whole[..., :3].mean()), 1e-5)
