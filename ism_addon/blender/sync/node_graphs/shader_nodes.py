# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts shader nodes to closures."""

from collections.abc import Mapping

from ....shading.builder import Value, constant
from .pattern_nodes import radial_tangent
from .reader import Closure, Converter, NodeView

ONE = constant(1.0)


def shader(name: str, output: str, **inputs: str) -> Converter:
    """The converter of a node that is one closure: its inputs, by the names of sockets."""

    def convert(view: NodeView) -> Mapping[str, list[Closure]]:
        values = {key: view.value(socket) for key, socket in inputs.items() if view.socket(socket) is not None}
        for key, socket in (("normal", "Normal"), ("coat_normal", "Coat Normal")):
            if view.socket(socket) is not None:
                values[key] = view.value(socket, view.reader.normal())
        if view.socket("Tangent") is not None and not values["anisotropy"].equals(0.0):
            values["tangent"] = view.value("Tangent", lambda: radial_tangent(view, "Z"))
        return {output: [Closure(name, ONE, values, view.node)]}

    return convert


def weighted(view: NodeView, closures: list[Closure], weight: Value) -> list[Closure]:
    """Closures with another factor; without those of weight 0."""
    scaled = (each._replace(weight=view.call("math_multiply", weight, each.weight)) for each in closures)
    return [each for each in scaled if not each.weight.equals(0.0)]


def mix_shader(view: NodeView) -> Mapping[str, list[Closure]]:
    """Mix Shader."""
    factor = view.call("saturate", view.value("Fac"))
    rest = view.call("math_subtract", ONE, factor)
    return {"Shader": weighted(view, view.closures(1), rest) + weighted(view, view.closures(2), factor)}


def add_shader(view: NodeView) -> Mapping[str, list[Closure]]:
    """Add Shader."""
    return {"Shader": view.closures(0) + view.closures(1)}


CONVERTERS: dict[str, Converter] = {
    "ShaderNodeBsdfDiffuse": shader("diffuse", "BSDF", color="Color", roughness="Roughness"),
    "ShaderNodeEmission": shader("emission", "Emission", color="Color", strength="Strength"),
    "ShaderNodeBsdfTransparent": shader("transparent", "BSDF", color="Color"),
    "ShaderNodeBsdfTranslucent": shader("translucent", "BSDF", color="Color"),
    "ShaderNodeSubsurfaceScattering": shader("subsurface", "BSSRDF", color="Color"),
    "ShaderNodeBsdfAnisotropic": shader(
        "glossy", "BSDF", color="Color", roughness="Roughness", anisotropy="Anisotropy", rotation="Rotation"
    ),
    "ShaderNodeBsdfMetallic": shader(
        "metallic",
        "BSDF",
        base_color="Base Color",
        edge_tint="Edge Tint",
        roughness="Roughness",
        anisotropy="Anisotropy",
        rotation="Rotation",
    ),
    "ShaderNodeBsdfSheen": shader("sheen", "BSDF", color="Color", roughness="Roughness"),
    "ShaderNodeBsdfGlass": shader("glass", "BSDF", color="Color", roughness="Roughness", ior="IOR"),
    "ShaderNodeBsdfPrincipled": shader(
        "principled",
        "BSDF",
        base_color="Base Color",
        metallic="Metallic",
        roughness="Roughness",
        ior="IOR",
        specular_ior_level="Specular IOR Level",
        specular_tint="Specular Tint",
        diffuse_roughness="Diffuse Roughness",
        anisotropy="Anisotropic",
        rotation="Anisotropic Rotation",
        transmission="Transmission Weight",
        coat="Coat Weight",
        coat_roughness="Coat Roughness",
        coat_ior="Coat IOR",
        coat_tint="Coat Tint",
        sheen="Sheen Weight",
        sheen_roughness="Sheen Roughness",
        sheen_tint="Sheen Tint",
        alpha="Alpha",
        emission_color="Emission Color",
        emission_strength="Emission Strength",
    ),
    "ShaderNodeMixShader": mix_shader,
    "ShaderNodeAddShader": add_shader,
}
