# SPDX-License-Identifier: GPL-3.0-or-later
"""Where only a small part of a light can illuminate a point, no energy is lost.

A shadow ray that finds no point on the light to aim at must not count as occluded. With a narrow spread only a small
part of a light illuminates a point of the floor; of a panel that is partly below the floor, only the strip above it.
"""

import itertools
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
    quality=replace(RAYS.quality, samples=4, virtual_lights=16, map_size=64, map_points=8192),
)
FILTER_WIDTH = 1.5  # px
#: Shapes of lights, and their height over their width.
SHAPES = {
    "square": (LightShape.RECTANGLE, 1.0),
    "rectangle": (LightShape.RECTANGLE, 1.0 / 3.0),
    "disk": (LightShape.ELLIPSE, 1.0),
    "ellipse": (LightShape.ELLIPSE, 1.0 / 3.0),
}


def over_a_plate(shape: str, size: float, degrees: float, is_plate_visible: bool) -> tuple[Scene, View]:
    """A light 4 m over a floor; a plate covers half of the illuminated area, which fills the view.

    If the plate is visible to the camera, it covers most of its own shadow.
    """
    light_shape, aspect = SHAPES[shape]
    spread = math.radians(degrees)
    area_light = light(light_shape, (0.3, 0.2, 4.0), (size, 0, 0), (0, -aspect * size, 0), spread=spread)
    extent = 1.2 * min(size / 2.0 + 3.5 * math.tan(min(spread, 2.0) / 2.0), 8.0)
    floor = quad((0.3 - 5 * extent, 0.2 - 5 * extent, 0), (10 * extent, 0, 0), (0, 10 * extent, 0))
    plate = quad((0.3 - 3 * extent, 0.2 - 3 * extent, 0.7), (3.1 * extent, 0, 0), (0, 3 * extent, 0))
    view = view_from_above(2 * extent, (80, 80), filter_width=FILTER_WIDTH)
    scene = make_scene([floor, plate], area_light)
    scene = replace(scene, instances=replace(scene.instances, visible=np.array([True, is_plate_visible])))
    return scene, replace(view, view_from_world=view.view_from_world @ transform(offset=(-0.3, -0.2, 0.0)))


def ratio_to_cycles(device, scene: Scene, view: View, settings: Settings, samples: int = 32) -> float:
    """Our mean over that of Cycles. Over a plate, the means of 16 to 512 Cycles samples differ by less than 0.1 %."""
    into_blender(scene, view)
    truth = direct_light(samples, FILTER_WIDTH)[..., :3].mean()
    return float(draw(device, *out_of_blender(), settings).color[..., :3].mean() / truth)


SIZES, SPREADS = (0.01, 1.0, 20.0), (0.5, 2.0, 10.0, 60.0, 180.0)
#: All pairs of a size and a spread, each for an angular shape and a round one, of which one is as wide
#: as high; so all pairs of a shape with a size and with a spread are there, too.
SPREAD_CASES = [
    (shape, size, degrees)
    for (row, size), (column, degrees) in itertools.product(enumerate(SIZES), enumerate(SPREADS))
    for shape in (("square", "ellipse"), ("rectangle", "disk"))[(row + column) % 2]
]


@pytest.mark.parametrize(("shape", "size", "degrees"), SPREAD_CASES)
def test_spreads_by_rays(device, assert_within, shape, size, degrees):
    assert_within(abs(ratio_to_cycles(device, *over_a_plate(shape, size, degrees, False), RAYS) - 1.0), 0.005)


@pytest.mark.parametrize("shape", ["square", "ellipse"])
@pytest.mark.parametrize("size", [0.01, 1.0, 20.0])
@pytest.mark.parametrize("degrees", [0.5, 10.0])
def test_spreads_by_shadow_maps(device, assert_within, shape, size, degrees):
    """Most points of a large light with a narrow spread illuminate no visible surface.

    For shadows, into which imperfect shadow maps leak light, see tests/unit/lights/test_spread_shadows.py.
    """
    assert_within(
        abs(ratio_to_cycles(device, *over_a_plate(shape, size, degrees, True), SMALL_SHADOW_MAPS) - 1.0), 0.03
    )


def behind_a_floor(size: float, fraction: float) -> tuple[Scene, View]:
    """A vertical panel light behind a floor; this fraction of its height is above the floor."""
    area_light = light(LightShape.RECTANGLE, (0.0, 1.5, (fraction - 0.5) * size), (size, 0, 0), (0, 0, size))
    return make_scene([quad((-5, -5, 0), (10, 0, 0), (0, 10, 0))], area_light), look_at((0.0, -6.0, 5.0), size=(96, 54))


@pytest.mark.parametrize("size", [1.0, 10.0, 100.0])
@pytest.mark.parametrize("fraction", [0.001, 0.01, 0.05, 0.2, 0.5])
def test_panels_partly_below_a_floor(device, assert_within, size, fraction):
    """The floor hides only what is below its own horizon, so the closed form without shadows is exact."""
    scene, view = behind_a_floor(size, fraction)
    truth = draw(device, replace(scene, lights=replace(scene.lights, casts_shadow=np.array([False]))), view, RAYS)
    assert_within(abs(draw(device, scene, view, RAYS).color[..., 0].mean() / truth.color[..., 0].mean() - 1.0), 0.005)


@pytest.mark.parametrize("fraction", [0.01, 0.2])
def test_an_occluder_before_a_panel(device, assert_within, fraction):
    scene, view = behind_a_floor(10.0, fraction)
    post = quad((-0.5, 0.0, 0.0), (1.0, 0, 0), (0, 0, 5.0 * fraction))
    settings = with_quality(RAYS, samples=64)
    assert_within(abs(ratio_to_cycles(device, *with_mesh(scene, view, post), settings, 128) - 1.0), 0.005)


def with_mesh(scene: Scene, view: View, mesh) -> tuple[Scene, View]:
    """The scene with one more mesh."""
    return make_scene([*scene.meshes, mesh], scene.lights), view
