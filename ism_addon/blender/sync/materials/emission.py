# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the light that materials emit: constant colours and strengths of Emission nodes and Principled BSDFs."""

import bpy
import numpy as np

from ....scene.limits import MAX_EMISSION, is_within
from ..diagnostics import Diagnostics
from . import nodes

EMISSION = "ShaderNodeEmission"

#: Sockets of color and strength by the shader's type.
SOCKETS = {EMISSION: ("Color", "Strength"), "ShaderNodeBsdfPrincipled": ("Emission Color", "Emission Strength")}


def read(shader: bpy.types.Node, name: str, findings: Diagnostics) -> np.ndarray:
    """(3,) W/(sr m²): the radiance of a material's shader; 0 for shaders that emit nothing."""
    black = np.zeros(3, np.float32)
    if shader.bl_idname not in SOCKETS:
        return black
    color_socket, strength_socket = (shader.inputs[socket] for socket in SOCKETS[shader.bl_idname])
    color, color_node = nodes.rgb(color_socket, 0.0)
    strength, strength_node = nodes.number(strength_socket)
    if (color_node is None and not color.any()) or (strength_node is None and strength == 0.0):
        return black
    for node, socket in ((color_node, color_socket), (strength_node, strength_socket)):
        if node is not None:
            issue = f"Materials whose {socket.name} is given by a node '{node.bl_label}' have the socket's own value"
            findings.warn(issue, name)
    radiance = color.astype(np.float64) * strength
    if not is_within(radiance, MAX_EMISSION).all():
        findings.warn("Materials too bright to be drawn emit nothing", name)
        return black
    return radiance.astype(np.float32)
