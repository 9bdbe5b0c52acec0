# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings about features of materials that this engine does not draw."""

import bpy

from ..diagnostics import Diagnostics
from . import nodes

#: By the shader's type: sockets with the value that is drawn, and the warning about other values and linked nodes.
PLAIN: dict[str, dict[str, tuple[float, str]]] = {
    "ShaderNodeBsdfPrincipled": {
        "Transmission Weight": (0.0, "What materials transmit is not drawn"),
        "Subsurface Weight": (0.0, "Subsurface scattering is drawn as diffuse reflection"),
        "Thin Film Thickness": (0.0, "Thin films are not drawn"),
    },
    "ShaderNodeBsdfMetallic": {"Thin Film Thickness": (0.0, "Thin films are not drawn")},
}

#: By the shader's type: warnings about any of them.
ALWAYS = {
    "ShaderNodeBsdfGlass": "What materials transmit is not drawn",
    "ShaderNodeBsdfTranslucent": "Translucent materials are drawn as diffuse ones",
    "ShaderNodeSubsurfaceScattering": "Subsurface scattering is drawn as diffuse reflection",
}

#: Distributions that are drawn: of microfacets, and of sheen.
DISTRIBUTIONS = {"GGX", "MULTI_GGX", "BECKMANN", "MICROFIBER"}


def warn_of_output(material: bpy.types.Material, output: bpy.types.Node | None, findings: Diagnostics) -> None:
    """Warn about the inputs of a material's output other than its surface."""
    if output is None:
        return
    if nodes.source(output.inputs["Volume"]) is not None:
        findings.warn("Volumes are not drawn by this engine", material.name)
    if nodes.source(output.inputs["Displacement"]) is not None and material.displacement_method != "BUMP":
        findings.warn("Displacement is drawn as a change of normals, without moving the surface", material.name)


def warn_of_shader(material: bpy.types.Material, shader: bpy.types.Node, findings: Diagnostics) -> None:
    """Warn about what is not drawn of a shader."""
    for name, (plain, issue) in PLAIN.get(shader.bl_idname, {}).items():
        socket = shader.inputs.get(name)
        if socket is not None and not _is(socket, plain):
            findings.warn(issue, material.name)
    if shader.bl_idname in ALWAYS:
        findings.warn(ALWAYS[shader.bl_idname], material.name)
    if getattr(shader, "distribution", "GGX") not in DISTRIBUTIONS:
        if shader.bl_idname == "ShaderNodeBsdfSheen":
            findings.warn("Sheen of the distribution Ashikhmin is drawn as microfibers", material.name)
        else:
            findings.warn("Glossy shaders of other distributions are drawn with that of GGX", material.name)
    if getattr(shader, "fresnel_type", "F82") != "F82":
        findings.warn("Metals of a complex index of refraction are drawn in their base color", material.name)


def _is(socket: bpy.types.NodeSocket, expected: float) -> bool:
    value, node = nodes.number(socket)
    return node is None and value == expected


def warn_of_mapping(material: bpy.types.Material, node: bpy.types.ShaderNodeTexImage, findings: Diagnostics) -> None:
    """Warn about unsupported mappings of an image texture."""
    mapped_by = nodes.source(node.inputs["Vector"])
    if mapped_by is not None and getattr(mapped_by.node, "from_instancer", False):
        findings.warn("Textures placed by what makes instances stand lie on the mesh's own UV map", material.name)
