# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that show each shader node with each of its options: a plane, beside which Cycles' picture can be held.

The node's first inputs vary over the plane, the others have values that are not their defaults. What it gives is
brought into the range of colours.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import bpy
import numpy as np


@dataclass(frozen=True)
class NodeCase:
    """A node with options. `varied`: inputs that vary over the plane, by index or name; `fixed`: values of others."""

    type: str  # bl_idname
    options: Mapping[str, Any] = field(default_factory=dict)
    output: int = 0  # index of the output that is shown
    varied: tuple[int | str, ...] = (0, 1, 2)
    fixed: Mapping[int | str, Any] = field(default_factory=dict)
    prepare: Callable[[bpy.types.Node], None] | None = None  # sets what is no option, such as a ramp's colours
    low: float = -1.0  # of what varies
    high: float = 2.0
    is_whole: bool = False  # whether what varies is rounded down to whole numbers
    label: str = ""

    @property
    def name(self) -> str:
        """The node, its options and its output."""
        options = (f"{key}={value}" for key, value in self.options.items())
        return " ".join([self.type.removeprefix("ShaderNode"), *options, self.label, f"output {self.output}"])


def options_of(type_: str, *names: str) -> Iterator[dict[str, Any]]:
    """All values of each option, the first value of the others."""
    properties = getattr(bpy.types, type_).bl_rna.properties
    for name in names:
        if name in properties:
            values = properties[name].enum_items.keys() if properties[name].type == "ENUM" else [False, True]
            yield from ({name: value} for value in values)


def build(case: NodeCase, material: bpy.types.Material) -> bool:
    """Make a material that shows the case. Returns whether this release has the node and the output."""
    if not hasattr(bpy.types, case.type):
        return False
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node = tree.nodes.new(case.type)
    for name, value in case.options.items():
        setattr(node, name, value)
    if case.prepare is not None:
        case.prepare(node)
    outputs = [socket for socket in node.outputs if socket.enabled and not getattr(socket, "is_unavailable", False)]
    if case.output >= len(outputs):
        return False
    enabled = [socket for socket in node.inputs if socket.enabled and not getattr(socket, "is_unavailable", False)]
    inputs: dict[int | str, bpy.types.NodeSocket] = {
        **dict(enumerate(enabled)),
        **{each.name: each for each in enabled},
    }
    coordinates = tree.nodes.new("ShaderNodeUVMap")
    for position, index in enumerate(case.varied):
        if index in inputs:
            tree.links.new(varying(tree, coordinates, inputs[index], position, case), inputs[index])
    for index, value in case.fixed.items():
        if index in inputs:
            inputs[index].default_value = value
    output, diffuse = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new("ShaderNodeBsdfDiffuse")
    # What is shown is within 0 and 1: a third of the value, plus a third.
    scaled = tree.nodes.new("ShaderNodeVectorMath")
    scaled.operation = "MULTIPLY_ADD"
    tree.links.new(outputs[case.output], scaled.inputs[0])
    scaled.inputs[1].default_value = scaled.inputs[2].default_value = (1 / 3, 1 / 3, 1 / 3)
    clamped = tree.nodes.new("ShaderNodeVectorMath")
    clamped.operation = "MINIMUM"
    tree.links.new(scaled.outputs[0], clamped.inputs[0])
    clamped.inputs[1].default_value = (1.0, 1.0, 1.0)
    tree.links.new(clamped.outputs[0], diffuse.inputs["Color"])
    tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    return True


def varying(
    tree: bpy.types.NodeTree, coordinates: bpy.types.Node, socket: bpy.types.NodeSocket, position: int, case: NodeCase
) -> bpy.types.NodeSocket:
    """An output that varies over the plane, differently for each position, for a socket."""
    mapping = tree.nodes.new("ShaderNodeMapping")
    span = case.high - case.low
    mapping.inputs["Scale"].default_value = (span, span, span)
    mapping.inputs["Location"].default_value = (case.low, case.low + 0.1 * position, case.low + 0.5)
    mapping.inputs["Rotation"].default_value = (0.3 * position, 0.0, 0.9 * position)
    tree.links.new(coordinates.outputs[0], mapping.inputs["Vector"])
    vector = mapping.outputs[0]
    if case.is_whole:
        rounded = tree.nodes.new("ShaderNodeVectorMath")
        rounded.operation = "FLOOR"
        tree.links.new(vector, rounded.inputs[0])
        vector = rounded.outputs[0]
    if socket.type in ("VECTOR", "RGBA"):
        return vector
    split = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(vector, split.inputs[0])
    return split.outputs[position % 2]


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
    yield from procedural_cases()


#: The inputs that vary of a texture: its vector, or its only number, or both.
POINTS = {"1D": (0,), "2D": (0,), "3D": (0,), "4D": (0, 1)}


def move(node: bpy.types.Node) -> None:
    """Give a texture a mapping of its own."""
    own = node.texture_mapping
    own.translation, own.rotation, own.scale = (0.3, 0.1, 0.2), (0.2, 0.4, 0.8), (1.5, 0.7, 1.2)


def procedural_cases() -> Iterator[NodeCase]:
    """Textures that are computed. Their details are larger than pixels."""
    yield from noise_cases()
    yield from voronoi_cases()
    for dimensions, varied in POINTS.items():
        for output in range(2):
            yield NodeCase("ShaderNodeTexWhiteNoise", {"noise_dimensions": dimensions}, output, varied, is_whole=True)
    yield NodeCase("ShaderNodeTexWhiteNoise", varied=(), label="unlinked")
    for type_ in ("2D", "3D"):
        orientation = 0.7 if type_ == "2D" else (0.3, -0.8, 0.5)
        for output in range(3):
            for anisotropy in (1.0, 0.6, 0.0):
                fixed = {"Scale": 0.7, "Frequency": 1.3, "Anisotropy": anisotropy, "Orientation": orientation}
                yield NodeCase("ShaderNodeTexGabor", {"gabor_type": type_}, output, (0,), fixed, label=f"{anisotropy}")
    for type_ in ("Noise", "Voronoi", "Gabor"):
        yield NodeCase(f"ShaderNodeTex{type_}", varied=(), fixed={"Scale": 3.0, "Detail": 0.0}, label="unlinked")
        yield NodeCase(f"ShaderNodeTex{type_}", varied=(0,), fixed={"Scale": 1.0}, prepare=move, label="own mapping")


def noise_cases() -> Iterator[NodeCase]:
    """All dimensions, types and outputs, distortion, and details that are whole numbers."""
    fixed = {"Scale": 1.2, "Detail": 1.6, "Roughness": 0.7, "Lacunarity": 1.7, "Offset": 0.8, "Gain": 1.6}
    name = "ShaderNodeTexNoise"
    for dimensions, varied in POINTS.items():
        common = {"noise_dimensions": dimensions}
        for output in range(2):
            for options in options_of(name, "noise_type", "normalize"):
                yield NodeCase(name, {**common, **options}, output, varied, fixed)
            distorted = {**fixed, "Distortion": 0.4}
            yield NodeCase(name, common, output, varied, distorted, label="distorted")
        for detail in (0.0, 1.0):
            yield NodeCase(name, common, 1, varied, {**fixed, "Detail": detail, "Roughness": 1.4}, label=f"{detail}")
    inputs = {"Scale": 1.0, "Detail": 1.0}
    for index in range(1, 6):
        options = {"noise_type": "HYBRID_MULTIFRACTAL"}
        yield NodeCase(name, options, 0, (0, index), inputs, low=0.5, label=f"varied {index}")


def voronoi_cases() -> Iterator[NodeCase]:
    """All dimensions, features, metrics and outputs; with and without octaves and normalization."""
    name, single = "ShaderNodeTexVoronoi", {"Scale": 1.0, "Randomness": 0.9, "Smoothness": 0.7, "Exponent": 1.3}
    octaves = {**single, "Detail": 0.6, "Roughness": 0.6, "Lacunarity": 1.8}
    for dimensions, varied in POINTS.items():
        common = {"voronoi_dimensions": dimensions}
        for options in options_of(name, "feature"):
            for output in range(4):
                yield NodeCase(name, {**common, **options}, output, varied, single)
                yield NodeCase(name, {**common, **options}, output, varied, octaves, label="octaves")
            normalized = {**common, **options, "normalize": True}
            for output in range(2):
                yield NodeCase(name, normalized, output, varied, octaves, label="octaves")
            has_metric = dimensions != "1D" and options["feature"] in ("F1", "F2", "SMOOTH_F1")
            for metric in options_of(name, "distance") if has_metric else ():
                yield NodeCase(name, {**normalized, **metric}, 0, varied, single)
    yield NodeCase(name, {"feature": "SMOOTH_F1"}, 1, (0,), {"Scale": 1.0, "Smoothness": 0.0}, label="not smooth")
