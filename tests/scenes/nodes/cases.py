# SPDX-License-Identifier: GPL-3.0-or-later
"""Each shader node with each of its options."""

from collections.abc import Iterator
from functools import partial

import bpy
import numpy as np

from . import pattern_cases, procedural_cases
from .case import NodeCase, options_of


def ramp(node: bpy.types.Node, interpolation: str) -> None:
    """Four colours at uneven positions."""
    node.color_ramp.interpolation = interpolation
    elements = node.color_ramp.elements
    elements[0].position, elements[0].color = 0.1, (0.9, 0.2, 0.1, 0.3)
    elements[1].position, elements[1].color = 0.9, (0.1, 0.2, 0.9, 1.0)
    for position, color in ((0.35, (0.2, 0.8, 0.3, 0.9)), (0.6, (0.9, 0.9, 0.1, 0.5))):
        elements.new(position).color = color


def wavy(node: bpy.types.Node, socket: str, scale: float = 9.0) -> None:
    """Link an input to a product of sines of the plane's coordinates."""
    tree = node.id_data
    links, coordinates = tree.links, tree.nodes.new("ShaderNodeUVMap")
    scaled, sines, split, product = (
        tree.nodes.new(f"ShaderNode{name}") for name in ("VectorMath", "VectorMath", "SeparateXYZ", "Math")
    )
    scaled.operation, sines.operation, product.operation = "SCALE", "SINE", "MULTIPLY"
    scaled.inputs["Scale"].default_value = scale
    links.new(coordinates.outputs[0], scaled.inputs[0])
    links.new(scaled.outputs[0], sines.inputs[0])
    links.new(sines.outputs[0], split.inputs[0])
    for k in range(2):
        links.new(split.outputs[k], product.inputs[k])
    links.new(product.outputs[0], node.inputs[socket])


def picture(node: bpy.types.Node, data: bool = False, floats: bool = False) -> None:
    """Give an Image Texture 5×4 random pixels, half of which are transparent."""
    image = bpy.data.images.new("Picture", 5, 4, alpha=True, is_data=data, float_buffer=floats)
    pixels = np.random.default_rng(0).random((20, 4), np.float32)
    pixels[::2, 3] = 1.0
    image.pixels.foreach_set(pixels.reshape(-1))
    node.image = image


def bend(node: bpy.types.Node) -> None:
    """Curves that are not straight."""
    for curve in node.mapping.curves:
        curve.points.new(0.3, 0.6)
        curve.points.new(0.7, 0.4)
    node.mapping.update()


def cases() -> Iterator[NodeCase]:
    """All cases."""
    for options in options_of("ShaderNodeMath", "operation"):
        yield NodeCase("ShaderNodeMath", options)
    yield NodeCase("ShaderNodeMath", {"use_clamp": True})
    for options in options_of("ShaderNodeVectorMath", "operation"):
        yield NodeCase("ShaderNodeVectorMath", options)
    for options in options_of("ShaderNodeClamp", "clamp_type"):
        yield NodeCase("ShaderNodeClamp", options, varied=(0,), fixed={1: 0.8, 2: 0.2})
    for data_type in ("FLOAT", "FLOAT_VECTOR"):
        for options in options_of("ShaderNodeMapRange", "interpolation_type", "clamp"):
            yield NodeCase("ShaderNodeMapRange", {"data_type": data_type, **options}, varied=(0, 3))
    for data_type in ("FLOAT", "VECTOR"):
        for options in options_of("ShaderNodeMix", "clamp_factor", "factor_mode"):
            yield NodeCase("ShaderNodeMix", {"data_type": data_type, **options})
    for options in options_of("ShaderNodeMix", "blend_type", "clamp_result"):
        yield NodeCase("ShaderNodeMix", {"data_type": "RGBA", **options}, low=0.0, high=1.2)
    for options in options_of("ShaderNodeMixRGB", "blend_type", "use_clamp"):
        yield NodeCase("ShaderNodeMixRGB", options, low=0.0, high=1.2)
    for options in options_of("ShaderNodeMapping", "vector_type"):
        yield NodeCase(
            "ShaderNodeMapping",
            options,
            varied=(0,),
            fixed={1: (0.2, 0.3, 0.1), 2: (0.3, 0.5, 0.7), 3: (1.5, 0.7, -1.0)},
        )
    for options in options_of("ShaderNodeVectorRotate", "rotation_type", "invert"):
        yield NodeCase("ShaderNodeVectorRotate", options, fixed={3: 0.8, 4: (0.3, 0.5, 0.7)}, varied=(0, 1))
    for mode in ("RGB", "HSV", "HSL"):
        yield NodeCase("ShaderNodeCombineColor", {"mode": mode}, low=0.0, high=1.0)
        for output in range(3):
            yield NodeCase("ShaderNodeSeparateColor", {"mode": mode}, output, low=0.0, high=1.2)
    yield NodeCase("ShaderNodeCombineXYZ")
    for output in range(3):
        yield NodeCase("ShaderNodeSeparateXYZ", output=output)
    for type_ in ("HueSaturation", "Invert", "Gamma", "BrightContrast", "RGBToBW"):
        yield NodeCase(f"ShaderNode{type_}", varied=(0, 1, 2, 3, 4), low=0.0, high=1.2)
    for interpolation in ("LINEAR", "CONSTANT", "EASE", "CARDINAL", "B_SPLINE"):
        for output in range(2):
            prepare = partial(ramp, interpolation=interpolation)
            yield NodeCase("ShaderNodeValToRGB", output=output, prepare=prepare, label=interpolation)
    for type_ in ("RGBCurve", "VectorCurve", "FloatCurve"):
        yield NodeCase(f"ShaderNode{type_}", prepare=bend, low=-0.5, high=1.5)
    yield NodeCase("ShaderNodeBlackbody", low=500.0, high=13000.0)
    yield NodeCase("ShaderNodeWavelength", low=350.0, high=800.0)
    for type_, count in (("NewGeometry", 6), ("ObjectInfo", 6), ("CameraData", 3), ("TexCoord", 7)):
        for output in range(count):
            yield NodeCase(f"ShaderNode{type_}", output=output, varied=())
    yield NodeCase("ShaderNodeFresnel", varied=(0,), low=0.5, high=3.0)
    for output in range(2):
        yield NodeCase("ShaderNodeLayerWeight", output=output, varied=(0,), low=0.0, high=1.0)
    for output in range(7):
        yield NodeCase("ShaderNodeLightPath", output=output)
    for options in options_of("ShaderNodeBump", "invert"):
        height, fixed = partial(wavy, socket="Height"), {"Distance": 0.1, "Strength": 0.7}
        yield NodeCase("ShaderNodeBump", options, varied=(), prepare=height, fixed=fixed)
        wide = {**fixed, "Filter Width": 3.0}
        yield NodeCase("ShaderNodeBump", options, varied=(), prepare=height, fixed=wide, label="wide filter")
    for options in options_of("ShaderNodeNormalMap", "space"):
        fixed = {"Strength": 0.7}
        yield NodeCase("ShaderNodeNormalMap", options, varied=("Color",), fixed=fixed, low=0.1, high=0.9)
    for options in options_of("ShaderNodeTexImage", "interpolation", "extension"):
        for output in range(2):
            yield NodeCase("ShaderNodeTexImage", options, output, varied=(0,), prepare=picture, low=-0.7, high=1.6)
    for label, encoding in (("data", {"data": True}), ("floats", {"floats": True})):
        prepare = partial(picture, **encoding)
        yield NodeCase("ShaderNodeTexImage", varied=(0,), prepare=prepare, label=label, low=-0.7, high=1.6)
    yield from procedural_cases.cases()
    yield from pattern_cases.cases()
