# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the light that materials emit, by Emission nodes and Principled BSDFs: the same from the whole surface."""

from collections.abc import Callable

import bpy
import numpy as np

from ....scene.limits import MAX_EMISSION, is_within
from ..diagnostics import Diagnostics
from . import nodes

EMISSION = "ShaderNodeEmission"

#: Sockets of color and strength by the shader's type.
SOCKETS = {EMISSION: ("Color", "Strength"), "ShaderNodeBsdfPrincipled": ("Emission Color", "Emission Strength")}

#: The mean color of an image, (3,); None without pixels.
MeanColor = Callable[[bpy.types.Image], np.ndarray | None]


def read(shader: bpy.types.Node, mean_color: MeanColor, name: str, findings: Diagnostics) -> np.ndarray:
    """(3,) W/(sr m²): the radiance of a material's shader; 0 for shaders that emit nothing."""
    black = np.zeros(3, np.float32)
    if shader.bl_idname not in SOCKETS:
        return black
    color_socket, strength_socket = (shader.inputs[socket] for socket in SOCKETS[shader.bl_idname])
    color, color_node = nodes.rgb(color_socket, 0.0)
    strength, strength_node = nodes.number(strength_socket)
    if (color_node is None and not color.any()) or (strength_node is None and strength == 0.0):
        return black
    if color_node is not None and (mean := mean_of(color_node, mean_color)) is not None:
        findings.warn("Surfaces that emit an image emit its mean colour", name)
        color, color_node = mean, None
    for node, socket in ((color_node, color_socket), (strength_node, strength_socket)):
        if node is not None:
            issue = f"Materials whose {socket.name} is given by a node '{node.bl_label}' have the socket's own value"
            findings.warn(issue, name)
    if shader.bl_idname != EMISSION and bpy.app.version >= (5, 0):
        strength = max(strength, 0.0)  # as in Cycles, which subtracted light before
    radiance = color.astype(np.float64) * strength
    if not is_within(radiance, MAX_EMISSION).all():
        findings.warn("Materials too bright to be drawn emit nothing", name)
        return black
    return radiance.astype(np.float32)


def mean_of(node: bpy.types.Node, mean_color: MeanColor) -> np.ndarray | None:
    """(3,) the mean color of an Image Texture; None for other nodes and for images without pixels."""
    is_image = node.bl_idname == "ShaderNodeTexImage" and node.image is not None
    return mean_color(node.image) if is_image else None
