# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts textures that are computed: Noise, White Noise, Voronoi and Gabor."""

from collections.abc import Mapping

import bpy

from ....shading.builder import Value, constant
from ....shading.textures import METRICS, voronoi_options
from .reader import Converter, NodeView
from .texture_nodes import texture_vector

NO_VECTOR = constant((0.0, 0.0, 0.0))
#: From this release on, Cycles hashes the cells of Voronoi textures as integers.
INTEGER_HASH = (5, 0)


def available(view: NodeView, key: str) -> Value:
    """The value of an input, 0 if the node's options hide it."""
    socket = view.socket(key)
    return constant(0.0) if socket is None or not socket.enabled or socket.is_unavailable else view.value(key)


def point(view: NodeView, dimensions: int, scale: Value) -> Value:
    """Where a texture is evaluated: its vector, or generated coordinates, and a fourth number."""
    vector = NO_VECTOR if dimensions == 1 else texture_vector(view)
    return view.call("texture_point", vector, available(view, "W"), scale, parameter=dimensions)


def noise(view: NodeView) -> Mapping[str, Value]:
    """Noise Texture."""
    node = view.node
    dimensions = int(node.noise_dimensions[0])
    at = point(view, dimensions, view.value("Scale"))
    at = view.call("noise_distorted", at, view.value("Distortion"), parameter=dimensions)
    roughness = view.call("math_maximum", available(view, "Roughness"), constant(0.0))
    others = (available(view, key) for key in ("Lacunarity", "Offset", "Gain"))
    operands = available(view, "Detail"), roughness, *others
    name = f"noise_{node.noise_type.lower()}"
    if node.noise_type == "FBM" and node.normalize:
        name += "_normalized"
    if not view.is_used("Color"):
        return {"Fac": view.call(name, at, *operands, parameter=dimensions)}
    color = view.call(f"{name}_color", at, *operands, parameter=dimensions)
    return {"Fac": view.call("separate_x", color), "Color": color}


def white_noise(view: NodeView) -> Mapping[str, Value]:
    """White Noise Texture. Without a link, its vector is a constant."""
    dimensions = int(view.node.noise_dimensions[0])
    vector = view.value("Vector") if dimensions > 1 else NO_VECTOR
    at = view.call("texture_point", vector, available(view, "W"), constant(1.0), parameter=dimensions)
    if not view.is_used("Color"):
        return {"Value": view.call("white_noise", at, parameter=dimensions)}
    color = view.call("white_noise_color", at, parameter=dimensions)
    return {"Value": view.call("separate_x", color), "Color": color}


def voronoi(view: NodeView) -> Mapping[str, Value]:
    """Voronoi Texture."""
    node, scale, feature = view.node, view.value("Scale"), view.node.feature.lower()
    dimensions = int(node.voronoi_dimensions[0])
    # All metrics are one in one dimension.
    metric = node.distance if dimensions > 1 else METRICS[0]
    options = voronoi_options(dimensions, metric, node.normalize, bpy.app.version >= INTEGER_HASH)
    at, randomness = point(view, dimensions, scale), view.value("Randomness")
    if feature == "n_sphere_radius":
        return {"Radius": view.call("voronoi_n_sphere_radius", at, randomness, parameter=options)}
    octaves = [available(view, key) for key in ("Detail", "Roughness", "Lacunarity")]
    if feature == "distance_to_edge":
        return {"Distance": view.call("voronoi_distance_to_edge", at, *octaves, randomness, parameter=options)}
    shape = [available(view, "Exponent"), randomness]
    if feature == "smooth_f1":
        shape.append(available(view, "Smoothness"))
    cells = view.call(f"voronoi_{feature}", at, *octaves, *shape, parameter=options)
    outputs = {"Distance": view.call("voronoi_distance", cells), "Color": view.call("voronoi_color", cells)}
    scaled = view.call("voronoi_position", cells, parameter=dimensions)
    outputs["Position"] = view.call("vector_divide", view.call("color_of", scaled), view.call("grey", scale))
    outputs["W"] = view.call("math_divide", view.call("alpha_of", scaled), scale)
    return outputs


def gabor(view: NodeView) -> Mapping[str, Value]:
    """Gabor Texture."""
    type_ = view.node.gabor_type
    at = point(view, int(type_[0]), view.value("Scale"))
    operands = [view.value(key) for key in ("Frequency", "Anisotropy", f"Orientation {type_}")]
    result = view.call(f"gabor_{type_.lower()}", at, *operands)
    return {
        name: view.call(f"separate_{axis}", result)
        for name, axis in zip(("Value", "Phase", "Intensity"), "xyz", strict=True)
    }


CONVERTERS: dict[str, Converter] = {
    "ShaderNodeTexNoise": noise,
    "ShaderNodeTexWhiteNoise": white_noise,
    "ShaderNodeTexVoronoi": voronoi,
    "ShaderNodeTexGabor": gabor,
}
