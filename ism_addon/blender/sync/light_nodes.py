# SPDX-License-Identifier: GPL-3.0-or-later
"""A light's shader nodes: an Emission node of constant colour and strength, with images, falloff and IES files.

There are warnings for all else.
"""

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from ...scene import LightImage, LightProfile
from ...scene.limits import MAX_DISTANCE
from . import ies
from .diagnostics import Diagnostics
from .light_images import LIGHT_TYPES, LightImages
from .materials import nodes

#: Outputs of a Light Falloff node: powers of the distance.
POWERS = {"Quadratic": 0, "Linear": 1, "Constant": 2}


@dataclass
class LightShader:
    """What a light's nodes do to its power."""

    factor: np.ndarray  # (3,)
    falloff_power: int = 0  # see Lights
    falloff_smooth: float = 0.0  # m²
    has_falloff: bool = False
    profile: LightProfile | None = None
    image: LightImage | None = None


def read(light: bpy.types.Light, name: str, images: LightImages, findings: Diagnostics) -> LightShader:
    """A light's shader. Its factor is zero, as in Cycles, if the output has no shader."""
    # Since Blender 5.2 every new light has nodes; Blender 6.0 removes the switch.
    if light.node_tree is None or not light.use_nodes:
        return LightShader(np.ones(3))
    shader = nodes.surface(nodes.output(light.node_tree))
    if shader is None:
        return LightShader(np.zeros(3))
    if shader.bl_idname != "ShaderNodeEmission":
        findings.warn(f"Lights whose surface is a node '{shader.bl_label}' shine as if they had none", name)
        return LightShader(np.ones(3))
    color, node = nodes.rgb(shader.inputs["Color"], 0.0)
    result = LightShader(color.astype(np.float64))
    if node is not None and light.type in LIGHT_TYPES and _gives_color(node, shader.inputs["Color"]):
        largest, result.image = images.of_node(node, name, findings)
        result.factor = np.full(3, largest)
    elif node is not None:
        findings.warn(f"Lights coloured by a node '{node.bl_label}' shine in the plain colour of its socket", name)
    strength, node = _strength(shader.inputs["Strength"], light, result, name, findings)
    if node is not None:
        findings.warn(f"Lights whose strength a node '{node.bl_label}' gives have the plain one of its socket", name)
    result.factor = result.factor * strength
    return result


def _gives_color(node: bpy.types.Node, socket: bpy.types.NodeSocket) -> bool:
    """Whether a socket has the colour of an Image Texture node."""
    output: Any = nodes.source(socket)
    return node.bl_idname == "ShaderNodeTexImage" and output.identifier == "Color"


def _strength(
    socket: bpy.types.NodeSocket, light: bpy.types.Light, result: LightShader, name: str, findings: Diagnostics
) -> tuple[float, bpy.types.Node | None]:
    """A strength, and the linked node that varies it unless `result` can say how, see nodes.number."""
    strength, node = nodes.number(socket)
    output: Any = nodes.source(socket)
    if node is None:
        return strength, None
    if node.bl_idname == "ShaderNodeLightFalloff" and light.type != "SUN" and not result.has_falloff:
        smooth, varying = nodes.number(node.inputs["Smooth"])
        result.has_falloff = True
        strength, other = _strength(node.inputs["Strength"], light, result, name, findings)
        if varying is not None or other is not None:
            return socket.default_value, varying or other
        result.falloff_power = POWERS[output.name]
        result.falloff_smooth = min(smooth, MAX_DISTANCE) if smooth > 0.0 else 0.0  # also if it is no number
        return strength, None
    if node.bl_idname == "ShaderNodeTexIES" and result.profile is None:
        strength, varying = _strength(node.inputs["Strength"], light, result, name, findings)
        if varying is not None:
            return socket.default_value, varying
        return strength * _profile(node, light, result, name, findings), None
    return socket.default_value, node


def _profile(
    node: bpy.types.ShaderNodeTexIES, light: bpy.types.Light, result: LightShader, name: str, findings: Diagnostics
) -> float:
    """Store an IES texture's profile: the factor of the strength."""
    if nodes.source(node.inputs["Vector"]) is not None:
        findings.warn("Lights whose IES Texture has a vector shine as if it had none", name)
    found = ies.read(_ies_text(node, light))
    if found is None:
        findings.warn("Lights whose IES file cannot be read shine evenly, a hundred times as strong", name)
        return ies.UNREADABLE
    profile, peak = found
    if light.type == "SUN":  # all of its light has one direction, as in Cycles
        return peak * float(profile.at(np.array([[0.0, 0.0, -1.0]]))[0])
    result.profile = profile
    return peak


def _ies_text(node: bpy.types.ShaderNodeTexIES, light: bpy.types.Light) -> str:
    """The text of a node's IES file; "" without one."""
    if node.mode == "INTERNAL":
        return node.ies.as_string() if node.ies else ""
    try:
        path = bpy.path.abspath(node.filepath, library=light.library)
        with open(path, encoding="utf-8", errors="replace") as file:
            return file.read(ies.MAX_CHARACTERS)
    except OSError:
        return ""
