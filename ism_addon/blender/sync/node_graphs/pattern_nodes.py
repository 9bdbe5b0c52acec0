# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts procedural textures that are patterns, and nodes of directions: Normal, Tangent and Vector Transform."""

from collections.abc import Mapping
from itertools import pairwise

from ....shading.builder import Value, constant
from ..geometry.attributes import AttributeSource
from .reader import Converter, NodeView
from .texture_nodes import texture_vector

ZERO = constant(0.0)
MIDDLE = constant((0.5, 0.5, 0.5))
#: What the axes X, Y, Z and the spherical distance of rings leave of a point.
RING_AXES = {"X": (0.0, 1.0, 1.0), "Y": (1.0, 0.0, 1.0), "Z": (1.0, 1.0, 0.0), "SPHERICAL": (1.0, 1.0, 1.0)}
BAND_DIRECTIONS = {"X": (1.0, 0.0, 0.0), "Y": (0.0, 1.0, 0.0), "Z": (0.0, 0.0, 1.0), "DIAGONAL": (0.5, 0.5, 0.5)}
#: A radial tangent is the product of this axis and the vector from the middle; Cycles has that about Y the other way.
TANGENT_AXES = {"X": (1.0, 0.0, 0.0), "Y": (0.0, -1.0, 0.0), "Z": (0.0, 0.0, 1.0)}


def scaled_vector(view: NodeView) -> Value:
    """The same, times the input Scale."""
    return view.call("vector_scale", texture_vector(view), view.value("Scale"))


def color_and_factor(view: NodeView, factor: Value) -> Mapping[str, Value]:
    """The outputs of a node whose color is grey."""
    return {"Color": view.call("grey", factor), "Fac": factor}


def wave_noise(view: NodeView, point: Value) -> Value:
    """By which the waves of a Wave Texture are distorted, from 0 to 1."""
    at = view.call("texture_point", point, ZERO, view.value("Detail Scale"), parameter=3)
    detail = view.value("Detail")
    # Cycles limits neither input: of a detail below 0, the part after the point counts.
    detail = view.call("math_add", detail, view.call("math_less_than", detail, ZERO))
    operands = detail, view.value("Detail Roughness"), constant(2.0), ZERO, ZERO
    return view.call("noise_fbm_normalized", at, *operands, parameter=3)


def wave(view: NodeView) -> Mapping[str, Value]:
    """Wave Texture."""
    node, point = view.node, view.call("off_integers", scaled_vector(view))
    if node.wave_type == "BANDS":
        phase = view.call("wave_bands", point, constant(BAND_DIRECTIONS[node.bands_direction]))
    else:
        phase = view.call("wave_rings", point, constant(RING_AXES[node.rings_direction]))
    phase = view.call("math_add", phase, view.value("Phase Offset"))
    noise = view.call("math_multiply_add", wave_noise(view, point), constant(2.0), constant(-1.0))
    phase = view.call("math_add", phase, view.call("math_multiply", view.value("Distortion"), noise))
    return color_and_factor(view, view.call(f"wave_{node.wave_profile.lower()}", phase))


def magic(view: NodeView) -> Mapping[str, Value]:
    """Magic Texture."""
    depth = constant(float(view.node.turbulence_depth))
    color = view.call("magic", texture_vector(view), view.value("Scale"), depth, view.value("Distortion"))
    return {"Color": color, "Fac": view.call("average", color)}


def checker(view: NodeView) -> Mapping[str, Value]:
    """Checker Texture."""
    factor = view.call("checker", view.call("off_integers", scaled_vector(view)))
    return {"Color": view.call("mix_vector", factor, view.value("Color2"), view.value("Color1")), "Fac": factor}


def brick(view: NodeView) -> Mapping[str, Value]:
    """Brick Texture."""
    node = view.node
    sizes = (view.value(key) for key in ("Bias", "Brick Width", "Row Height"))
    moved = (constant(float(each)) for each in (node.offset, node.squash))
    mortar = (view.value(key) for key in ("Mortar Size", "Mortar Smooth"))
    rows = (constant(float(each)) for each in (node.offset_frequency, node.squash_frequency))
    tint_and_mortar = view.call("brick", scaled_vector(view), *sizes, *moved, *mortar, *rows)
    tint, factor = (view.call(f"separate_{axis}", tint_and_mortar) for axis in "xy")
    color = view.call("mix_vector", tint, view.value("Color1"), view.value("Color2"))
    return {"Color": view.call("mix_vector", factor, color, view.value("Mortar")), "Fac": factor}


def gradient(view: NodeView) -> Mapping[str, Value]:
    """Gradient Texture."""
    return color_and_factor(view, view.call(f"gradient_{view.node.gradient_type.lower()}", texture_vector(view)))


def normal(view: NodeView) -> Mapping[str, Value]:
    """Normal, whose first output has its direction as the output's own value."""
    direction = view.call("vector_normalize", constant(tuple(view.node.outputs[0].default_value)))
    given = view.call("vector_normalize", view.value("Normal"))
    return {"Normal": direction, "Dot": view.call("vector_dot_product", direction, given)}


def radial_tangent(view: NodeView, axis: str) -> Value:
    """The direction around an axis through the middle of the generated coordinates."""
    from_middle = view.call("vector_subtract", view.reader.generated(), MIDDLE)
    around = view.call("vector_cross_product", constant(TANGENT_AXES[axis]), from_middle)
    return view.call("surface_tangent", around)


def tangent(view: NodeView) -> Mapping[str, Value]:
    """Tangent."""
    node = view.node
    if node.direction_type == "RADIAL":
        return {"Tangent": radial_tangent(view, node.axis)}
    along_u = view.call("color_of", view.reader.attribute(AttributeSource.TANGENT, node.uv_map))
    return {"Tangent": view.call("surface_tangent", along_u)}


def vector_transform(view: NodeView) -> Mapping[str, Value]:
    """Vector Transform. From the space of the camera to that of the object and back it is by world space."""
    node, vector = view.node, view.value("Vector")
    spaces = [node.convert_from.lower(), node.convert_to.lower()]
    if spaces[0] != spaces[1] and "world" not in spaces:
        spaces.insert(1, "world")
    for source, target in pairwise(spaces):
        if source != target:
            vector = view.call(f"{target}_from_{source}_{node.vector_type.lower()}", vector)
    return {"Vector": vector}


CONVERTERS: dict[str, Converter] = {
    "ShaderNodeTexWave": wave,
    "ShaderNodeTexMagic": magic,
    "ShaderNodeTexChecker": checker,
    "ShaderNodeTexBrick": brick,
    "ShaderNodeTexGradient": gradient,
    "ShaderNodeNormal": normal,
    "ShaderNodeTangent": tangent,
    "ShaderNodeVectorTransform": vector_transform,
}
