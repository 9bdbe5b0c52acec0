# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the nodes linked to shader sockets, and evaluates the few that have a constant value."""

import operator
from collections.abc import Callable
from typing import Any

import bpy
import numpy as np

from ....color import REC709, between_spaces, blackbody
from ....scene.limits import is_within
from . import images

#: Nodes of which `number` may know the result if their first two inputs are constant, and operations of Math nodes.
ARITHMETIC_NODES = {"ShaderNodeMath", "ShaderNodeLightFalloff"}
ARITHMETIC: dict[str, Callable[[float, float], float]] = {
    "ADD": operator.add,
    "SUBTRACT": operator.sub,
    "MULTIPLY": operator.mul,
    "DIVIDE": lambda a, b: a / b if b else 0.0,  # as in Cycles
}


def tree(owner: bpy.types.Material | bpy.types.World) -> bpy.types.NodeTree | None:
    """The node tree of a material or a world, None if it is not used: before Blender 5.0 it could be switched off."""
    used = bpy.app.version >= (5, 0) or owner.use_nodes
    return owner.node_tree if used else None


def output(node_tree: bpy.types.NodeTree) -> bpy.types.Node | None:
    """The output node that Cycles uses, for Cycles or for all engines; if there is none, EEVEE's."""
    return node_tree.get_output_node("CYCLES") or node_tree.get_output_node("EEVEE")


def surface(output_node: bpy.types.Node | None) -> bpy.types.Node | None:
    """The shader node linked to an output's surface."""
    linked = source(output_node.inputs["Surface"]) if output_node else None
    return linked.node if linked else None


def number(socket: bpy.types.NodeSocket) -> tuple[float, bpy.types.Node | None]:
    """A socket's number, by itself or by nodes of constants; and the linked node if it is no such node, else None."""
    linked = source(socket)
    if linked is None:
        return socket.default_value, None
    node = linked.node
    if node.bl_idname == "ShaderNodeValue":
        return linked.default_value, None
    operands = [number(each) for each in node.inputs[:2]] if node.bl_idname in ARITHMETIC_NODES else []
    if operands and not any(other for _, other in operands):
        if node.bl_idname == "ShaderNodeMath" and node.operation in ARITHMETIC and not node.use_clamp:
            return ARITHMETIC[node.operation](*(number for number, _ in operands)), None
        if node.bl_idname == "ShaderNodeLightFalloff" and linked.name == "Quadratic" and operands[1][0] == 0.0:
            return operands[0][0], None
    return socket.default_value, node


def rgb(socket: bpy.types.NodeSocket, fallback: float) -> tuple[np.ndarray, bpy.types.Node | None]:
    """(3,) a socket's colour, by itself or by nodes of constants, see `color`; and the linked node as in `number`."""
    linked = source(socket)
    if linked is None:
        return color(socket.default_value, fallback), None
    if linked.node.bl_idname == "ShaderNodeRGB":
        return color(linked.default_value, fallback), None
    if linked.node.bl_idname == "ShaderNodeBlackbody":
        temperature, node = number(linked.node.inputs["Temperature"])
        if node is None and np.isfinite(temperature):
            return color(between_spaces(images.working_space(), REC709) @ blackbody(temperature), fallback), None
    return color(socket.default_value, fallback), linked.node


def value(socket: bpy.types.NodeSocket, fallback: float) -> tuple[Any, bpy.types.Node | None]:
    """The value of a number or colour socket, see `number` and `rgb`."""
    return rgb(socket, fallback) if socket.type == "RGBA" else number(socket)


def source(socket: bpy.types.NodeSocket) -> bpy.types.NodeSocket | None:
    """The output socket linked to an input, through reroutes and muted nodes; None if there is none."""
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


def color(values: Any, fallback: float) -> np.ndarray:
    """(3,) colour of a socket's values; `fallback` replaces those that are not finite or beyond limits."""
    rgb = np.array(values[:3], np.float32)
    return np.where(is_within(rgb), rgb, np.float32(fallback))
