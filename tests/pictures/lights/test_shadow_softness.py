# SPDX-License-Identifier: GPL-3.0-or-later
"""A light whose shadow sees another size than its light: as if the shadow were that of a light of that size."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.gl.context import open_device
from ism_addon.scene import Lights, LightShape
from ism_addon.settings import Method, Settings, Shadow
from tests.pictures.test_picture import SETTINGS
from tests.support.small_scenes import draw, light, make_scene, quad, view_from_above, with_quality

FLOOR = quad((-4, -4, 0), (8, 0, 0), (0, 8, 0))
PLATE = quad((-0.5, -0.5, 1), (1, 0, 0), (0, 1, 0))
VIEW = view_from_above(4.0, (64, 64), height=0.9)
#: By name: a light of a size.
LIGHTS = {
    "rectangle": lambda size: light(axis_u=(size, 0, 0), axis_v=(0, -size, 0), radiance=1.0 / size**2),
    "ellipse": lambda size: light(
        LightShape.ELLIPSE, axis_u=(size, 0, 0), axis_v=(0, -size, 0), radiance=1.0 / size**2
    ),
    "point": lambda size: light(LightShape.POINT, radius=size / 2.0),
    "spot": lambda size: light(LightShape.SPOT, radius=size / 2.0, spread=2.0, blend=1.0),
    "sun": lambda size: light(LightShape.SUN, spread=2.0 * float(np.arctan(size / 4.0))),
}


#: What little it takes to tell sizes apart: see the measured differences below.
FEW_SAMPLES = {
    Method.RAY_TRACED: with_quality(SETTINGS[Method.RAY_TRACED], samples=16),
    Method.SHADOW_MAPS: with_quality(SETTINGS[Method.SHADOW_MAPS], virtual_lights=32, map_size=64),
}


def visibility(device, lights: Lights, settings: Settings) -> np.ndarray:
    """(H,W): the picture over that without shadows."""
    scene = make_scene([FLOOR, PLATE], lights)
    shadowed = draw(device, scene, VIEW, settings).color[..., 0]
    return shadowed / draw(device, scene, VIEW, replace(settings, shadow=Shadow(enabled=False))).color[..., 0]


@pytest.mark.parametrize("method", Method)
@pytest.mark.parametrize("name", LIGHTS)
def test_the_shadow_is_that_of_a_light_of_another_size(device, name, method):
    """Of a small light, whose parts are all seen at about the same angle. Measured: 0.2 by rays, 0.06 by maps."""
    settings, make = FEW_SAMPLES[method], LIGHTS[name]
    same = visibility(device, make(0.25), settings)
    for softness in (0.25, 2.0):
        soft = replace(make(0.25), shadow_softness=np.array([softness], np.float32))
        ours, other = (visibility(device, each, settings) for each in (soft, make(0.25 * softness)))
        assert np.abs(ours - other).mean() < 0.45 * np.abs(same - other).mean()


@pytest.mark.parametrize("name", LIGHTS)
def test_without_softness_shadows_are_exact_after_one_sample(device, name):
    """And unshadowed light is that of the light's size."""
    hard = replace(LIGHTS[name](0.5), shadow_softness=np.zeros(1, np.float32))
    visible = visibility(device, hard, with_quality(SETTINGS[Method.RAY_TRACED], samples=1))
    # Cards fuse other operations in the two programs, which round to other values of 16-bit targets.
    rounding = 0.0 if device.name.startswith("llvmpipe") else 2.0**-10
    assert ((visible == 0.0) | (np.abs(visible - 1.0) <= rounding)).all()
    assert 0.05 < (visible == 0.0).mean() < 0.5


def test_a_shader_for_another_size_is_compiled_only_if_a_light_has_one():
    device = open_device()
    for softness in (1.0, 2.0):
        with device.gl:
            scene = make_scene([FLOOR, PLATE], light(shadow_softness=softness))
            draw(device, scene, VIEW, with_quality(SETTINGS[Method.RAY_TRACED], samples=2))
        has_variant = any(("softness", 1) in constants for _, _, constants in device.programs)
        assert has_variant == (softness != 1.0)
    device.close()
