# SPDX-License-Identifier: GPL-3.0-or-later
"""A light's shader nodes: an Emission node of constant colour and strength, with falloff; warnings for all else."""

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from ...scene.limits import MAX_DISTANCE
from .diagnostics import Diagnostics
from .materials import nodes

#: Outputs of a Light Falloff node: powers of the distance.
POWERS = {"Quadratic": 0, "Linear": 1, "Constant": 2}


@dataclass
class LightShader:
    """What a light's nodes do to its power."""

    factor: np.ndarray  # (3,)
    falloff_power: int = 0  # see Lights
    falloff_smooth: float = 0.0  # m²


def read(light: bpy.types.Light, name: str, findings: Diagnostics) -> LightShader:
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
    if node is not None:
        findings.warn(f"Lights coloured by a node '{node.bl_label}' shine in the plain colour of its socket", name)
    result = LightShader(color.astype(np.float64))
    strength, node = nodes.number(shader.inputs["Strength"])
    if node is not None and node.bl_idname == "ShaderNodeLightFalloff" and light.type != "SUN":
        strength, node = _falloff(shader.inputs["Strength"], result)
    if node is not None:
        findings.warn(f"Lights whose strength a node '{node.bl_label}' gives have the plain one of its socket", name)
    result.factor = result.factor * strength
    return result


def _falloff(socket: bpy.types.NodeSocket, result: LightShader) -> tuple[float, bpy.types.Node | None]:
    """Store what the linked Light Falloff node does. Its strength; or the socket's, and the node that varies it."""
    output: Any = nodes.source(socket)
    (strength, varying), (smooth, other) = (nodes.number(output.node.inputs[each]) for each in ("Strength", "Smooth"))
    if varying is not None or other is not None:
        return socket.default_value, varying or other
    result.falloff_power = POWERS[output.name]
    result.falloff_smooth = min(smooth, MAX_DISTANCE) if smooth > 0.0 else 0.0  # also if it is no number
    return strength, None
