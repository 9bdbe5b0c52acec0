# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the world's background as a constant radiance."""

import bpy
import numpy as np

from ...scene import World
from ...scene.limits import is_within
from .diagnostics import Diagnostics
from .materials import nodes


def read(world: bpy.types.World | None, findings: Diagnostics) -> World:
    """The Background node's colour × strength, or the world's colour if it has no nodes.

    Black if there is no world; 0 for values that are not finite or beyond limits.
    """
    if world is None:
        return World.of(radiance=np.zeros(3))
    radiance = _radiance(world, findings)
    ray_visibility = getattr(world, "cycles_visibility", None)  # Cycles can be switched off
    if ray_visibility is not None and not (ray_visibility.camera and ray_visibility.diffuse):
        findings.warn("The ray visibility of worlds is not obeyed", world.name)
    return World.of(radiance=np.where(is_within(radiance), radiance, 0.0))


def _radiance(world: bpy.types.World, findings: Diagnostics) -> np.ndarray:
    node_tree = nodes.tree(world)
    if node_tree is None:
        return nodes.color(world.color, 0.0)
    output = nodes.output(node_tree)
    if output is not None and nodes.source(output.inputs["Volume"]) is not None:
        findings.warn("Volumes of worlds are not drawn", world.name)
    shader = nodes.surface(output)
    if shader is None:
        return np.zeros(3)
    if shader.bl_idname != "ShaderNodeBackground":
        findings.warn(
            f"A world whose surface is a node '{shader.bl_label}' is drawn in its viewport colour", world.name
        )
        return nodes.color(world.color, 0.0)
    color, node = nodes.rgb(shader.inputs["Color"], 0.0)
    if node is not None:
        findings.warn(
            f"A world coloured by a node '{node.bl_label}' is drawn in the Background's plain colour", world.name
        )
    strength, node = nodes.number(shader.inputs["Strength"])
    if node is not None:
        findings.warn(f"A world whose strength a node '{node.bl_label}' gives has its socket's", world.name)
    return color * np.float64(strength)
