# SPDX-License-Identifier: GPL-3.0-or-later
"""A light's shader nodes: the constant colour and strength of an Emission node, and warnings for all else."""

import bpy
import numpy as np

from .diagnostics import Diagnostics
from .materials import nodes


def factor(light: bpy.types.Light, name: str, findings: Diagnostics) -> np.ndarray:
    """(3,) the factor of the light's power; zeros, as in Cycles, if the output has no shader."""
    # Since Blender 5.2 every new light has nodes; Blender 6.0 removes the switch.
    if light.node_tree is None or not light.use_nodes:
        return np.ones(3)
    shader = nodes.surface(nodes.output(light.node_tree))
    if shader is None:
        return np.zeros(3)
    if shader.bl_idname != "ShaderNodeEmission":
        findings.warn(f"Lights whose surface is a node '{shader.bl_label}' shine as if they had none", name)
        return np.ones(3)
    color, node = nodes.rgb(shader.inputs["Color"], 0.0)
    if node is not None:
        findings.warn(f"Lights coloured by a node '{node.bl_label}' shine in the plain colour of its socket", name)
    strength, node = nodes.number(shader.inputs["Strength"])
    if node is not None:
        findings.warn(f"Lights whose strength a node '{node.bl_label}' gives have the plain one of its socket", name)
    return color.astype(np.float64) * strength
