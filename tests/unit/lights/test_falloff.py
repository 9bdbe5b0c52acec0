# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights with a Light Falloff node: bounds, both methods, and no cost without one. Compared with Cycles elsewhere."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.culling.surface_bounds import SurfaceBounds
from ism_addon.gpu.gl.context import open_device
from ism_addon.gpu.lights import bounds_with_falloff, by_type
from ism_addon.scene import Lights, LightShape
from ism_addon.settings import Method, Settings, Shadow
from tests.pictures.lights.test_shadow_softness import FEW_SAMPLES
from tests.pictures.test_picture import SETTINGS
from tests.support.light_grids import irradiance
from tests.support.small_scenes import draw, light, make_scene, quad, view_from_above, with_quality

FLOOR = quad((-4, -4, 0), (8, 0, 0), (0, 8, 0))
PLATE = quad((-0.5, -0.5, 1), (1, 0, 0), (0, 1, 0))
VIEW = view_from_above(4.0, (32, 32), height=0.9)
LIGHTS = {
    "rectangle": lambda **falloff: light(**falloff),
    "point": lambda **falloff: light(LightShape.POINT, radiance=3.0, **falloff),
    "sphere": lambda **falloff: light(LightShape.POINT, radius=0.3, radiance=3.0, **falloff),
    "spot": lambda **falloff: light(LightShape.SPOT, spread=2.0, blend=0.5, radiance=3.0, **falloff),
}
FALLOFFS = [{"falloff_power": 1}, {"falloff_power": 2}, {"falloff_smooth": 4.0}]


@pytest.mark.parametrize("falloff", FALLOFFS, ids=["linear", "constant", "smooth"])
@pytest.mark.parametrize("name", LIGHTS)
def test_no_light_is_brighter_than_its_bound(name, falloff):
    """Boxes of points at any distance, some of which face the light."""
    random = np.random.default_rng(0)
    (light_type, _, one), *_ = by_type(LIGHTS[name](**falloff))
    plain = replace(one, falloff_power=np.zeros(1, np.int32), falloff_smooth=np.zeros(1, np.float32))
    for _ in range(60):
        points = random.normal(size=3) * 10.0 ** random.uniform(-1.0, 2.0) + random.uniform(-0.3, 0.3, (8, 3))
        normal = one.position[0] - points[0]
        normal /= np.linalg.norm(normal)
        low, high, cone = np.append(points.min(0), 1.0), np.append(points.max(0), 0.0), np.append(normal, 1.0)
        surfaces = SurfaceBounds.of(*(row.astype(np.float32)[None, None] for row in (low, high, cone)))
        (bound,), (estimate,) = bounds_with_falloff(light_type, one, np.zeros(3), "Linear Rec.709").irradiance(surfaces)
        for point in points:
            distance = np.linalg.norm(point - one.position[0])
            smooth = distance**2 / (distance**2 + one.falloff_smooth[0])
            truth = irradiance(point, normal, plain, 0, 12) * distance ** one.falloff_power[0] * smooth
            assert truth <= 1.05 * bound[0] + 1e-9
        assert 0.0 <= estimate[0] <= 1.0001 * bound[0]


def visibility(device, one: Lights, settings: Settings) -> np.ndarray:
    """(H,W): the picture over that without shadows."""
    scene, without = make_scene([FLOOR, PLATE], one), replace(settings, shadow=Shadow(enabled=False))
    shadowed, unshadowed = (draw(device, scene, VIEW, each).color[..., 0] for each in (settings, without))
    return np.divide(shadowed, unshadowed, out=np.zeros_like(shadowed), where=unshadowed > 0.0)


@pytest.mark.parametrize("method", Method)
@pytest.mark.parametrize("name", LIGHTS)
def test_shadows_are_as_dark_as_without_falloff(device, name, method):
    """Distances hardly differ over a light. Rays correct what differs, with some noise."""
    plain = visibility(device, LIGHTS[name](), FEW_SAMPLES[method])
    assert (plain < 0.9).mean() > 0.05
    for falloff in FALLOFFS:
        visible = visibility(device, LIGHTS[name](**falloff), FEW_SAMPLES[method])
        assert np.abs(visible - plain).mean() < 0.03, falloff


@pytest.mark.parametrize(("samples", "bound"), [(1, 0.02), (16, 0.005), (256, 0.0012)])
@pytest.mark.parametrize("falloff", FALLOFFS, ids=["linear", "constant", "smooth"])
def test_rays_correct_the_falloff_of_a_large_light(device, falloff, samples, bound):
    """A square over a floor, against the sum over a grid of its points. Measured: 0.0155, 0.0038 and 0.0008."""
    one = light(**falloff)
    elsewhere = quad((3, 3, 1.5), (0.05, 0, 0), (0, 0.05, 0))  # something that could cast a shadow
    view = view_from_above(4.0, (16, 16), height=0.9)
    settings = with_quality(SETTINGS[Method.RAY_TRACED], samples=samples)
    ours = draw(device, make_scene([FLOOR, elsewhere], one), view, settings).color[..., 0]
    across, middle = (np.arange(48) + 0.5) / 48 - 0.5, ((np.arange(16) + 0.5) / 16 - 0.5) * 4.0
    x, y = (middle[:, None] - across for _ in range(2))
    square = x[None, :, None] ** 2 + y[:, None, :, None] ** 2 + 4.0
    factor = square ** (one.falloff_power[0] / 2.0) * square / (square + one.falloff_smooth[0])
    theirs = (0.6 / np.pi * 4.0 / square**2 * factor).mean((2, 3))
    assert np.abs(ours - theirs).mean() < bound * theirs.mean()


def test_only_lights_with_falloff_need_a_shader_for_it():
    device = open_device()
    for power in (0, 1):
        with device.gl:
            scene = make_scene([FLOOR, PLATE], light(falloff_power=power, visible_camera=True))
            draw(device, scene, VIEW, with_quality(SETTINGS[Method.RAY_TRACED], samples=2))
        assert any(("falloff", 1) in constants for _, _, constants in device.programs) == (power > 0)
    device.close()
