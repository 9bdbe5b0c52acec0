# SPDX-License-Identifier: GPL-3.0-or-later
"""The world's background as one radiance."""

import bpy
import numpy as np

from ..ranges import within
from ..scene import World
from . import nodes
from .findings import Findings


def read(world: bpy.types.World | None, findings: Findings) -> World:
    """The Background node's colour × strength, or the world's colour where it has no nodes.

    No world is black, and so is what is no number.
    """
    radiance = np.zeros(3) if world is None else _radiance(world, findings)
    return World(np.where(within(radiance), radiance, 0.0).astype(np.float32))


def _radiance(world: bpy.types.World, findings: Findings) -> np.ndarray:
    node_tree = nodes.tree(world)
    if node_tree is None:
        return nodes.color(world.color, 0.0)
    shader = nodes.surface(node_tree)
    if shader is None:
        return np.zeros(3)
    if shader.bl_idname != "ShaderNodeBackground":
        findings.note(
            f"A world whose surface is a node '{shader.bl_label}' is drawn in its viewport colour", world.name
        )
        return nodes.color(world.color, 0.0)
    color, strength = shader.inputs["Color"], shader.inputs["Strength"]
    fed_by = nodes.source(color)
    rgb = color.default_value
    if fed_by is not None and fed_by.node.bl_idname == "ShaderNodeRGB":
        rgb = fed_by.default_value
    elif fed_by is not None:
        findings.note(
            f"A world coloured by a node '{fed_by.node.bl_label}' is drawn in the Background's plain colour", world.name
        )
    return nodes.color(rgb, 0.0) * np.float64(strength.default_value)
