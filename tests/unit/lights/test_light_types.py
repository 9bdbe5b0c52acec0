# SPDX-License-Identifier: GPL-3.0-or-later
"""The interface of light types: a type defined by the tests is drawn correctly by both methods, beside area lights."""

import numpy as np
import pytest

from ism_addon.gpu import lights
from ism_addon.gpu.emission.emissive_lights import EMISSIVE_MESH
from ism_addon.gpu.gl.context import open_device
from ism_addon.gpu.lights.world.table import ENVIRONMENT, MAP_SUN, WORLD
from ism_addon.scene import LightShape
from ism_addon.settings import Method
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    SMALL_SHADOW_MAPS,
    draw,
    join_lights,
    light,
    make_scene,
    quad,
    view_from_above,
    with_quality,
)

from .bulb import BULB, Bulb

FLOOR = quad((-4, -4, 0), (8, 0, 0), (0, 8, 0))
#: Between the bulb and the right half of the floor.
PLATE = quad((0.02, -4, 1), (4, 0, 0), (0, 8, 0))
SETTINGS = {Method.RAY_TRACED: SMALL_SETTINGS, Method.SHADOW_MAPS: SMALL_SHADOW_MAPS}

#: Largest NRMSE. In shadow maps the floor's own discs occlude a little of its light.
MAX_ERROR = {Method.RAY_TRACED: 2e-4, Method.SHADOW_MAPS: 0.02}


def nrmse(ours: np.ndarray, expected: np.ndarray) -> float:
    """Root mean square of the difference over the mean."""
    return float(np.sqrt(((ours - expected) ** 2).mean()) / expected.mean())


@pytest.fixture
def bulb_device(monkeypatch):
    """A device that compiles shaders for bulbs too."""
    monkeypatch.setattr(lights, "LIGHT_TYPES", (*lights.LIGHT_TYPES, Bulb()))
    device = open_device()
    with device.gl:
        yield device
    device.close()


def closed_form(position, intensity: float, points: np.ndarray) -> np.ndarray:
    """(H,W) radiance of the floor of base color 0.6 at points (H,W,2)."""
    to = np.asarray(position) - np.concatenate([points, np.zeros((*points.shape[:2], 1))], 2)
    return 0.6 / np.pi * intensity * to[..., 2] / np.linalg.norm(to, axis=2) ** 3


def pixel_centres() -> np.ndarray:
    """(32,32,2) m: the pixels' centres of a view from above, 3 m wide."""
    x = (np.arange(32) + 0.5) / 32 * 3.0 - 1.5
    return np.stack(np.meshgrid(x, x), 2)


@pytest.mark.parametrize("method", Method, ids=[method.label for method in Method])
def test_a_type_defined_by_tests_is_drawn_correctly(bulb_device, method):
    position, settings = (0.0, 0.0, 2.0), with_quality(SETTINGS[method], samples=16, map_size=128, map_points=2000)
    bulb = light(BULB, position, radiance=7.0)
    view = view_from_above(3.0, height=0.9)
    expected = closed_form(position, 7.0, pixel_centres())
    unshadowed = draw(bulb_device, make_scene([FLOOR], bulb), view, settings).color[..., 0]
    assert nrmse(unshadowed, expected) < MAX_ERROR[method]
    shadowed = draw(bulb_device, make_scene([FLOOR, PLATE], bulb), view, settings).color[..., 0]
    assert nrmse(shadowed[:, :12], expected[:, :12]) < MAX_ERROR[method]
    visibility = shadowed[:, 20:].mean() / expected[:, 20:].mean()
    assert visibility == 0.0 if method == Method.RAY_TRACED else visibility < 0.3  # discs leave holes


def test_rays_correct_an_irradiance_that_is_not_exact(monkeypatch, tmp_path):
    """The bulb's irradiance is too low by a third, both where a plate occludes it and where not."""
    glsl, exact = tmp_path / "bulb.glsl", "return max(dot(n, to), 0.0)"
    text = Bulb.glsl.read_text("utf-8")
    assert exact in text
    glsl.write_text(text.replace(exact, f"{exact} / 1.5"), "utf-8")
    inexact = Bulb()
    inexact.glsl, inexact.is_exact = glsl, lambda lights, row: False
    monkeypatch.setattr(lights, "LIGHT_TYPES", (*lights.LIGHT_TYPES, inexact))
    device = open_device()
    view, settings = view_from_above(3.0, height=0.9), with_quality(SMALL_SETTINGS, samples=64)
    with device.gl:
        shadowed = draw(device, make_scene([FLOOR, PLATE], light(BULB, radiance=7.0)), view, settings).color[..., 0]
    device.close()
    expected = closed_form((0.0, 0.0, 2.0), 7.0, pixel_centres())
    assert nrmse(shadowed[:, :12], expected[:, :12]) < 0.01
    assert shadowed[:, 20:].max() < 1e-3 * expected.mean()


def test_a_bulb_and_an_area_light_add_up(bulb_device):
    bulb, area = light(BULB, (0.5, 0.0, 2.0), radiance=3.0), light(LightShape.ELLIPSE, (0.0, 0.5, 2.0))
    view, meshes = view_from_above(3.0, height=0.9), [FLOOR, PLATE]
    alone = [draw(bulb_device, make_scene(meshes, each), view, SMALL_SETTINGS).color[..., :3] for each in (bulb, area)]
    together = draw(bulb_device, make_scene(meshes, join_lights(bulb, area)), view, SMALL_SETTINGS).color[..., :3]
    assert all(each.any() for each in alone)
    assert together == pytest.approx(sum(alone), abs=0.02)


@pytest.mark.parametrize("light_type", lights.LIGHT_TYPES, ids=[each.name for each in lights.LIGHT_TYPES])
def test_every_shape_has_one_type(light_type):
    assert all(sum(shape in each.shapes for each in lights.LIGHT_TYPES) == 1 for shape in light_type.shapes)
    assert light_type.glsl.is_file()


def test_all_shapes_have_a_type():
    assert {shape for each in lights.LIGHT_TYPES for shape in each.shapes} == {
        *LightShape,
        EMISSIVE_MESH,
        WORLD,
        ENVIRONMENT,
        MAP_SUN,
    }
