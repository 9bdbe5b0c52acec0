# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of nodes of patterns, projections, directions and attributes."""

from collections.abc import Iterator
from functools import partial

import bpy
import numpy as np

from .case import ATTRIBUTES, SECOND_UV_MAP, NodeCase, options_of

#: Values of the inputs that are no coordinates, by their index.
WAVE = {1: 0.3, 2: 4.0, 3: 2.5, 4: 1.5, 5: 0.6, 6: 0.7}
COLORS = {1: (0.8, 0.3, 0.1, 1.0), 2: (0.1, 0.4, 0.9, 1.0)}
BRICK = {**COLORS, 3: (0.2, 0.9, 0.3, 1.0), 4: 1.2, 5: 0.06, 6: 0.5, 7: 0.1, 8: 0.7, 9: 0.3}
TEXELS = 16


def cases() -> Iterator[NodeCase]:
    """All cases."""
    yield from pattern_cases()
    yield from projection_cases()
    yield from direction_cases()
    yield from attribute_cases()


def pattern_cases() -> Iterator[NodeCase]:
    """Procedural textures."""
    wave = partial(NodeCase, "ShaderNodeTexWave", varied=(0,))
    for options in options_of("ShaderNodeTexWave", "wave_type", "bands_direction", "wave_profile"):
        yield wave(options, fixed={1: 0.3, 6: 0.4})
    for options in options_of("ShaderNodeTexWave", "rings_direction"):
        yield wave({"wave_type": "RINGS", **options}, fixed={1: 0.3})
        yield wave({"wave_type": "RINGS", **options}, fixed=WAVE, label="distorted")
    for detail in (0.0, 1.0, 7.3):
        yield wave(output=1, fixed={**WAVE, 3: detail}, label=f"detail {detail}")
    yield wave(varied=tuple(range(7)), low=0.0, high=2.0, label="all vary")
    magic = partial(NodeCase, "ShaderNodeTexMagic", varied=(0,))
    for depth in range(11):
        yield magic({"turbulence_depth": depth}, fixed={1: 0.5, 2: 1.3})
    for output in range(2):
        yield magic({"turbulence_depth": 3}, output, varied=(0, 1, 2), low=0.1, high=1.0, label="all vary")
    yield magic({"turbulence_depth": 3}, fixed={1: 0.5, 2: 0.0}, label="undistorted")
    for output in range(2):
        yield NodeCase("ShaderNodeTexChecker", output=output, varied=(0,), fixed={**COLORS, 3: 2.3})
        yield NodeCase("ShaderNodeTexBrick", output=output, varied=(0,), fixed=BRICK)
        yield NodeCase("ShaderNodeTexGradient", output=output, varied=(0,))
    yield NodeCase("ShaderNodeTexChecker", varied=(0, 1, 2, 3), low=0.5, label="all vary")
    for options in (
        *({"offset": 0.3, "offset_frequency": count} for count in (1, 2, 3)),
        *({"squash": 1.7, "squash_frequency": count} for count in (1, 2, 3)),
        {"offset": 0.2, "offset_frequency": 3, "squash": 0.6, "squash_frequency": 2},
    ):
        yield NodeCase("ShaderNodeTexBrick", options, varied=(0,), fixed={**BRICK, 6: 0.0})
    yield NodeCase("ShaderNodeTexBrick", varied=(0, 1, 2, 3, 5, 6, 7), fixed=BRICK, low=0.0, high=1.0, label="all vary")
    for options in options_of("ShaderNodeTexGradient", "gradient_type"):
        yield NodeCase("ShaderNodeTexGradient", options, varied=(0,))
    for type_, fixed in (("Wave", WAVE), ("Magic", {}), ("Checker", {}), ("Brick", BRICK), ("Gradient", {})):
        for shape in ("plane", "curved"):
            yield NodeCase(f"ShaderNodeTex{type_}", varied=(), fixed=fixed, shape=shape, label="unlinked")
        yield NodeCase(f"ShaderNodeTex{type_}", varied=(), fixed=fixed, prepare=map_texture, label="mapped")
    for high in (1.0, 3.0):
        for output in range(3):
            yield NodeCase("ShaderNodeSeparateColor", {"mode": "HSL"}, output, low=-0.2, high=high, label=f"to {high}")


def map_texture(node: bpy.types.Node) -> None:
    """Give a texture a mapping of its own."""
    own = node.texture_mapping
    own.vector_type, own.mapping_x, own.mapping_y = "POINT", "Y", "X"
    own.use_min, own.min = True, (0.4, 0.3, 0.1)
    own.translation, own.rotation, own.scale = (0.3, 0.1, 0.2), (0.1, 0.2, 0.5), (1.2, 0.7, 2.0)


def show_image(node: bpy.types.Node, coordinates: str = "") -> None:
    """Give an Image Texture coloured texels, and coordinates by the name of their output."""
    image = bpy.data.images.get("Texels") or bpy.data.images.new("Texels", TEXELS, TEXELS, alpha=True)
    pixels = np.random.default_rng(2).random((TEXELS * TEXELS, 4))
    pixels[:, 3] = 1.0
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(pixels.astype(np.float32).ravel())
    image.pack()
    node.image = image
    if coordinates:
        tree = node.id_data
        tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs[coordinates], node.inputs["Vector"])


def projection_cases() -> Iterator[NodeCase]:
    """Image Texture."""
    image = partial(NodeCase, "ShaderNodeTexImage", varied=(), prepare=show_image)
    for projection in ("FLAT", "BOX", "SPHERE", "TUBE"):
        yield image({"projection": projection}, label="unlinked")
        for interpolation in ("Linear", "Closest", "Cubic", "Smart"):
            options = {"projection": projection, "interpolation": interpolation}
            yield image(options, varied=(0,), low=0.0, high=1.0)
        for options in options_of("ShaderNodeTexImage", "extension"):
            yield image({"projection": projection, **options}, varied=(0,), low=-0.3, high=1.3)
        for coordinates in ("Generated", "Object"):
            prepare, options = partial(show_image, coordinates=coordinates), {"projection": projection}
            for shape in ("tilted", "curved", "back"):
                yield image(options, prepare=prepare, shape=shape, label=coordinates)
    for blend in (0.2, 0.6, 1.0):
        for shape in ("tilted", "curved"):
            yield image({"projection": "BOX", "projection_blend": blend}, varied=(0,), low=0.0, high=1.0, shape=shape)


def set_direction(node: bpy.types.Node) -> None:
    """Set the direction of a Normal, which is not of length 1."""
    node.outputs[0].default_value = (0.3, -0.5, 0.4)


def refer_to_object(node: bpy.types.Node) -> None:
    """Give a Texture Coordinate another object."""
    other = bpy.data.objects.new("Other", None)
    other.location, other.rotation_euler, other.scale = (1.0, 2.0, 0.5), (0.4, 0.2, 0.7), (4.0, 3.0, -2.0)
    bpy.context.scene.collection.objects.link(other)
    node.object = other


def direction_cases() -> Iterator[NodeCase]:
    """Nodes whose results depend on the surface's direction or on an object."""
    for output in range(2):
        yield NodeCase("ShaderNodeNormal", output=output, varied=(0,), prepare=set_direction)
    spaces = "WORLD", "OBJECT", "CAMERA"
    for shape in ("tilted", "back", "mirrored"):
        for type_ in ("POINT", "VECTOR", "NORMAL"):
            low, high = (-10.0, 10.0) if type_ == "POINT" else (-1.0, 2.0)
            for source in spaces:
                for target in spaces:
                    options = {"vector_type": type_, "convert_from": source, "convert_to": target}
                    yield NodeCase("ShaderNodeVectorTransform", options, varied=(0,), low=low, high=high, shape=shape)
    for shape in ("plane", "tilted", "back", "mirrored", "curved"):
        for axis in "Z" if shape == "plane" else "XYZ":  # about the others the plane's tangent is zero
            yield NodeCase("ShaderNodeTangent", {"direction_type": "RADIAL", "axis": axis}, varied=(), shape=shape)
        yield NodeCase("ShaderNodeTangent", {"direction_type": "UV_MAP"}, varied=(), shape=shape)
        for output in range(7):
            yield NodeCase("ShaderNodeNewGeometry", output=output, varied=(), shape=shape, label="geometry")
            yield NodeCase("ShaderNodeTexCoord", output=output, varied=(), shape=shape, label="coordinates")
        of_another = partial(NodeCase, "ShaderNodeTexCoord", output=3, prepare=refer_to_object)
        yield of_another(varied=(), shape=shape, label="of another")
        for output in range(6):
            yield NodeCase("ShaderNodeObjectInfo", output=output, varied=(), shape=shape, label="object")
    for output in range(6):
        yield NodeCase("ShaderNodeObjectInfo", output=output, varied=(), shape="instance", label="object")
    yield NodeCase("ShaderNodeObjectInfo", output=5, varied=(), label="Zwölf")
    for name in ("UVMap", SECOND_UV_MAP, "Missing"):
        options = {"direction_type": "UV_MAP", "uv_map": name}
        yield NodeCase("ShaderNodeTangent", options, varied=(), shape="grid")


def attribute_cases() -> Iterator[NodeCase]:
    """Attribute, Color Attribute and UV Map."""
    attribute = partial(NodeCase, varied=(), shape="grid")
    for name in (*ATTRIBUTES, "UVMap", SECOND_UV_MAP, "position", "Missing", ""):
        for output in range(4):
            yield attribute("ShaderNodeAttribute", {"attribute_name": name}, output)
    for name in (*(name for name, (type_, _) in ATTRIBUTES.items() if "COLOR" in type_), "Missing", ""):
        for output in range(2):
            yield attribute("ShaderNodeVertexColor", {"layer_name": name}, output)
    for name in ("UVMap", SECOND_UV_MAP, "Missing", ""):
        yield attribute("ShaderNodeUVMap", {"uv_map": name})
