# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a light sends something, a ray that finds nothing to aim at does not stand for a hidden light.

Narrow spreads light a floor from a small part of a light, and panels that look over a floor from a thin strip.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.scene import LightShape, Scene, View
from ism_addon.settings import SSAO, Method, Quality, Settings, Shadow
from tests.scenes.cycles import direct_light
from tests.stress.pictures.into_blender import into_blender, out_of_blender
from tests.support.small_scenes import draw, light, look_at, make_scene, quad, transform, view_from_above, with_quality

RAYS = Settings(ssao=SSAO(enabled=False), quality=Quality(samples=32, error_threshold=0.0))
SMALL_SHADOW_MAPS = replace(
    RAYS,
    shadow=Shadow(method=Method.SHADOW_MAPS),
    quality=replace(RAYS.quality, samples=16, virtual_lights=16, map_size=64, map_points=8192),
)
FILTER = 1.5  # px
#: Of a light: its shape, and its height as a part of its width.
SHAPES = {
    "square": (LightShape.RECTANGLE, 1.0),
    "rectangle": (LightShape.RECTANGLE, 1.0 / 3.0),
    "disk": (LightShape.ELLIPSE, 1.0),
    "ellipse": (LightShape.ELLIPSE, 1.0 / 3.0),
}


def over_a_plate(shape: str, size: float, degrees: float, seen: bool) -> tuple[Scene, View]:
    """A light 4 m over a floor, half of what it lights below a plate, seen as large as what it lights.

    The plate hides most of its shadow where it is seen itself.
    """
    kind, part = SHAPES[shape]
    spread = math.radians(degrees)
    lamp = light(kind, (0.3, 0.2, 4.0), (size, 0, 0), (0, -part * size, 0), spread=spread)
    reach = 1.2 * min(size / 2.0 + 3.5 * math.tan(min(spread, 2.0) / 2.0), 8.0)
    floor = quad((0.3 - 5 * reach, 0.2 - 5 * reach, 0), (10 * reach, 0, 0), (0, 10 * reach, 0))
    plate = quad((0.3 - 3 * reach, 0.2 - 3 * reach, 0.7), (3.1 * reach, 0, 0), (0, 3 * reach, 0))
    view = view_from_above(2 * reach, (80, 80), filter_width=FILTER)
    scene = make_scene([floor, plate], lamp)
    scene = replace(scene, instances=replace(scene.instances, visible=np.array([True, seen])))
    return scene, replace(view, view_from_world=view.view_from_world @ transform(offset=(-0.3, -0.2, 0.0)))


def ratio_to_cycles(device, scene: Scene, view: View, settings: Settings, samples: int = 32) -> float:
    """Of the pictures' means. Over a plate, 16 to 512 samples of Cycles' give means within 0.1 %."""
    into_blender(scene, view)
    truth = direct_light(samples, FILTER)[..., :3].mean()
    return float(draw(device, *out_of_blender(), settings).color[..., :3].mean() / truth)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("size", [0.01, 1.0, 20.0])
@pytest.mark.parametrize("degrees", [0.5, 2.0, 10.0, 60.0, 180.0])
def test_spreads_by_rays(device, within, shape, size, degrees):
    within(abs(ratio_to_cycles(device, *over_a_plate(shape, size, degrees, False), RAYS) - 1.0), 0.005)


@pytest.mark.parametrize("shape", ["square", "ellipse"])
@pytest.mark.parametrize("size", [0.01, 1.0, 20.0])
@pytest.mark.parametrize("degrees", [0.5, 10.0])
def test_spreads_by_shadow_maps(device, within, shape, size, degrees):
    """Most points of a large light with a narrow spread are of no pixel's light.

    Of shadows, which imperfect maps let light into, see tests/unit/lights/test_spread_shadows.py.
    """
    within(abs(ratio_to_cycles(device, *over_a_plate(shape, size, degrees, True), SMALL_SHADOW_MAPS) - 1.0), 0.03)


def behind_a_floor(size: float, part: float) -> tuple[Scene, View]:
    """A standing panel, of whose height so much looks over the floor."""
    lamp = light(LightShape.RECTANGLE, (0.0, 1.5, (part - 0.5) * size), (size, 0, 0), (0, 0, size))
    return make_scene([quad((-5, -5, 0), (10, 0, 0), (0, 10, 0))], lamp), look_at((0.0, -6.0, 5.0), size=(96, 54))


@pytest.mark.parametrize("size", [1.0, 10.0, 100.0])
@pytest.mark.parametrize("part", [0.001, 0.01, 0.05, 0.2, 0.5])
def test_panels_that_look_over_a_floor(device, within, size, part):
    """The floor hides what is below it, which is below its horizon too: its light has a closed form."""
    scene, view = behind_a_floor(size, part)
    truth = draw(device, replace(scene, lights=replace(scene.lights, casts_shadow=np.array([False]))), view, RAYS)
    within(abs(draw(device, scene, view, RAYS).color[..., 0].mean() / truth.color[..., 0].mean() - 1.0), 0.005)


@pytest.mark.parametrize("part", [0.01, 0.2])
def test_something_stands_before_a_panel(device, within, part):
    scene, view = behind_a_floor(10.0, part)
    post = quad((-0.5, 0.0, 0.0), (1.0, 0, 0), (0, 0, 5.0 * part))
    settings = with_quality(RAYS, samples=64)
    within(abs(ratio_to_cycles(device, *into_stage(scene, view, post), settings, 128) - 1.0), 0.005)


def into_stage(scene: Scene, view: View, mesh) -> tuple[Scene, View]:
    """The scene with one more mesh."""
    return make_scene([*scene.meshes, mesh], scene.lights), view
