# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings about features of materials that this engine does not draw.

A new Principled BSDF has some gloss. Only more gloss than that has a warning: otherwise each file would have one.
"""

import bpy

from ..diagnostics import Diagnostics
from . import nodes

#: By the shader's type: sockets with the value that is drawn, and the warning about other values and linked nodes.
PLAIN: dict[str, dict[str, tuple[float, str]]] = {
    "ShaderNodeBsdfPrincipled": {
        "Metallic": (0.0, "Metal is drawn as if it were none"),
        "Alpha": (1.0, "Transparent materials are drawn opaque"),
        "Transmission Weight": (0.0, "Transmission is not drawn"),
        "Subsurface Weight": (0.0, "Subsurface scattering is not drawn"),
        "Diffuse Roughness": (0.0, "Diffuse roughness is not drawn"),
        "Coat Weight": (0.0, "Coats and sheen are not drawn"),
        "Sheen Weight": (0.0, "Coats and sheen are not drawn"),
    },
    "ShaderNodeBsdfDiffuse": {"Roughness": (0.0, "Diffuse roughness is not drawn")},
}

#: Limits of a Principled BSDF without a warning about gloss: the values of a new one.
MIN_ROUGHNESS = 0.5
MAX_GLOSS = {"IOR": 1.5, "Specular IOR Level": 0.5, "Anisotropic": 0.0, "Thin Film Thickness": 0.0}
GLOSS = "Gloss is not drawn"


def warn_of_output(material: bpy.types.Material, output: bpy.types.Node | None, findings: Diagnostics) -> None:
    """Warn about the inputs of a material's output other than its surface."""
    if output is None:
        return
    if nodes.source(output.inputs["Volume"]) is not None:
        findings.warn("Volumes are not drawn by this engine", material.name)
    if nodes.source(output.inputs["Displacement"]) is not None and material.displacement_method != "BUMP":
        findings.warn("Displacement is drawn as a change of normals, without moving the surface", material.name)


def warn_of_shader(material: bpy.types.Material, shader: bpy.types.Node, findings: Diagnostics) -> None:
    """Warn about inputs of the surface's shader other than its colour."""
    for name, (plain, issue) in PLAIN.get(shader.bl_idname, {}).items():
        socket = shader.inputs.get(name)
        if socket is not None and not _is(socket, plain):
            findings.warn(issue, material.name)
    if shader.bl_idname == "ShaderNodeBsdfPrincipled" and _is_glossy(shader):
        findings.warn(GLOSS, material.name)


def _is(socket: bpy.types.NodeSocket, expected: float) -> bool:
    value, node = nodes.number(socket)
    return node is None and value == expected


def _is_glossy(shader: bpy.types.Node) -> bool:
    """Whether a Principled BSDF may have more gloss than a new one. Blender's sockets are float32."""
    if _is(shader.inputs["Specular IOR Level"], 0.0):
        return False
    roughness, node = nodes.number(shader.inputs["Roughness"])
    if node is not None or roughness < MIN_ROUGHNESS:
        return True
    for name, limit in MAX_GLOSS.items():
        value, node = nodes.number(shader.inputs[name]) if name in shader.inputs else (limit, None)
        if node is not None or value > limit:
            return True
    return False


def warn_of_mapping(material: bpy.types.Material, node: bpy.types.ShaderNodeTexImage, findings: Diagnostics) -> None:
    """Warn about unsupported mappings of an image texture."""
    mapped_by = nodes.source(node.inputs["Vector"])
    if mapped_by is not None and getattr(mapped_by.node, "from_instancer", False):
        findings.warn("Textures placed by what makes instances stand lie on the mesh's own UV map", material.name)
