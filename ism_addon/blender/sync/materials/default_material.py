# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces without a material: a diffuse grey, and from Blender 5.0 on that of Principled BSDF, as in Cycles."""

import bpy
import numpy as np

from ....scene import MATERIAL_INPUTS
from ....shading.builder import Builder, constant
from ..node_graphs.reader import Closure
from .lobes import ONE, ZERO, Lobes
from .surface import Reflection

WHITE = constant((1.0, 1.0, 1.0))


def default_reflection() -> Reflection:
    """What they reflect."""
    color = np.full(3, MATERIAL_INPUTS["base_color"].default)
    if bpy.app.version < (5, 0):
        return Reflection(color)
    builder = Builder()
    normal = builder.call("geometry_normal")
    inputs = {
        "base_color": constant(color),
        "specular_tint": WHITE,
        "roughness": constant(0.5),
        "ior": constant(1.5),
        "specular_ior_level": constant(0.5),
        "normal": normal,
        "coat_normal": normal,
        **dict.fromkeys(("metallic", "sheen", "coat", "transmission"), ZERO),
    }
    lobes = Lobes(builder, normal).of(Closure("principled", ONE, inputs, None), WHITE)
    return Reflection(color, -1, *builder.finish([each.operation for each in lobes]))
