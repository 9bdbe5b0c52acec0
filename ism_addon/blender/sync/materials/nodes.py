# SPDX-License-Identifier: GPL-3.0-or-later
"""What feeds a shader socket, and the few node trees whose colour can be told."""

from typing import Any

import bpy
import numpy as np

from ....scene.limits import is_within

#: The nodes of textures behind which only the mesh's own UVs stand.
UV_OUTPUTS = {("ShaderNodeUVMap", "UV"), ("ShaderNodeTexCoord", "UV")}


def tree(owner: bpy.types.Material | bpy.types.World) -> bpy.types.NodeTree | None:
    """The node tree that draws a material or a world; before Blender 5.0 it could be switched off."""
    used = bpy.app.version >= (5, 0) or owner.use_nodes
    return owner.node_tree if used else None


def output(node_tree: bpy.types.NodeTree) -> bpy.types.Node | None:
    """The output that Cycles takes, its own or one for all engines; else EEVEE's."""
    return node_tree.get_output_node("CYCLES") or node_tree.get_output_node("EEVEE")


def surface(shown: bpy.types.Node | None) -> bpy.types.Node | None:
    """The shader node that an output shows."""
    fed_by = source(shown.inputs["Surface"]) if shown else None
    return fed_by.node if fed_by else None


def number(socket: bpy.types.NodeSocket) -> tuple[float, bpy.types.Node | None]:
    """What a Value node gives a socket, or its own number; and the node of another kind that feeds it, if one does."""
    fed_by = source(socket)
    if fed_by is None:
        return socket.default_value, None
    if fed_by.node.bl_idname == "ShaderNodeValue":
        return fed_by.default_value, None
    return socket.default_value, fed_by.node


def rgb(socket: bpy.types.NodeSocket, otherwise: float) -> tuple[np.ndarray, bpy.types.Node | None]:
    """(3,) what an RGB node gives a socket, or its own colour, as `color` has it; and a node of another kind."""
    fed_by = source(socket)
    if fed_by is None:
        return color(socket.default_value, otherwise), None
    if fed_by.node.bl_idname == "ShaderNodeRGB":
        return color(fed_by.default_value, otherwise), None
    return color(socket.default_value, otherwise), fed_by.node


def value(socket: bpy.types.NodeSocket, otherwise: float) -> tuple[Any, bpy.types.Node | None]:
    """What a socket of a number or of a color has: see `number` and `rgb`."""
    return rgb(socket, otherwise) if socket.type == "RGBA" else number(socket)


def source(socket: bpy.types.NodeSocket) -> bpy.types.NodeSocket | None:
    """The output that feeds an input, behind reroutes and muted nodes; None where nothing does."""
    while socket is not None and (links := socket.links):
        link = links[0]
        if link.is_muted or not link.is_valid:
            return None
        node = link.from_node
        if node.bl_idname == "NodeReroute":
            socket = node.inputs[0]
        elif node.mute:
            inner = (passed.from_socket for passed in node.internal_links if passed.to_socket == link.from_socket)
            socket = next(inner, None)
        else:
            return link.from_socket
    return None


def uv_layer(vector: bpy.types.NodeSocket) -> str:
    """The UV layer that a UV Map node names for a texture's Vector input; "" where it is the one that renders."""
    placed_by = source(vector)
    return placed_by.node.uv_map if placed_by is not None and placed_by.node.bl_idname == "ShaderNodeUVMap" else ""


def color(values: bpy.types.bpy_prop_array, otherwise: float) -> np.ndarray:
    """(3,) of a colour socket, with a stand-in for what is no number."""
    rgb = np.array(values[:3], np.float32)
    return np.where(is_within(rgb), rgb, np.float32(otherwise))
