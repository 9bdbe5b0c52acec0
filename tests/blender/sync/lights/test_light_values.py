# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights with values that no file should have: each is drawn as Blender clamps it, or left out with one sentence."""

import math

import bpy
import numpy as np
import pytest

from ism_addon.scene.arrays import array_specs
from ism_addon.scene.limits import MAX_DISTANCE, MAX_EMISSION

NAN, INFINITE = math.nan, math.inf
TYPES = ("AREA", "POINT", "SPOT", "SUN")
#: Properties of lights, and of their objects, with values.
DATA = {
    "energy": (NAN, INFINITE, -INFINITE, 1e30, 1e12, -5.0, 0.0),
    "color": ((NAN, 1.0, 1.0), (INFINITE, 0.0, 0.0), (-1.0, 2.0, 0.5)),
    "exposure": (NAN, 1000.0, -1000.0),
    "temperature": (NAN, 0.0, 1e9),
    "size": (NAN, INFINITE, -1.0, 0.0, 1e9, 1e-30),
    "spread": (NAN, -1.0, 0.0, 10.0),
    "shadow_soft_size": (NAN, INFINITE, -1.0, 0.0, 1e9, 1e-30),
    "spot_size": (NAN, -1.0, 0.0, math.pi, 10.0),
    "spot_blend": (NAN, -1.0, 0.0, 1.0, 5.0),
    "angle": (NAN, INFINITE, -1.0, 0.0, math.pi, 10.0),
}
OBJECT = {
    "location": ((NAN, 0.0, 0.0), (INFINITE, 0.0, 0.0), (1e30, 0.0, 0.0)),
    "scale": ((0.0, 0.0, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 1.0), (NAN, 1.0, 1.0), (1e30, 1.0, 1.0), (1e-30,) * 3),
    "rotation_euler": ((NAN, 0.0, 0.0), (INFINITE, 0.0, 0.0)),
}
CASES = [
    (light_type, owner, name, value)
    for light_type in TYPES
    for owner, properties in (("data", DATA), ("object", OBJECT))
    for name, values in properties.items()
    for value in values
]


@pytest.mark.parametrize(("light_type", "owner", "name", "value"), CASES)
def test_no_value_of_a_light_is_read_as_something_that_cannot_be_drawn(add, read_scene, light_type, owner, name, value):
    light = bpy.data.lights.new("Lamp", light_type)
    if not hasattr(light, name) and owner == "data":
        return  # of another type of light, or a later Blender
    thing = add("Lamp", light)
    light.energy = 10.0
    if name == "temperature":
        light.use_temperature = True
    setattr(light if owner == "data" else thing, name, value)
    scene = read_scene()
    lights = scene.lights
    for field in array_specs(type(lights)):
        assert np.isfinite(getattr(lights, field)).all(), field
    assert (np.abs(lights.position) <= MAX_DISTANCE).all() and (np.abs(lights.emission) <= MAX_EMISSION).all()
    assert (lights.radius >= 0.0).all() and (lights.spread >= 0.0).all() and (lights.spread <= np.pi + 1e-6).all()
    assert len(scene.warnings) <= 1
    if not len(lights.shape) and not scene.warnings:
        assert not light.energy or not any(light.color) or getattr(light, "exposure", 0.0) < 0.0, (
            "it is left out silently"
        )
