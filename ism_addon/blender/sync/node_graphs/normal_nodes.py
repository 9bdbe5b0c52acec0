# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts nodes that change normals, and displacement, which is drawn as a change of normals."""

from collections.abc import Mapping

import bpy

from ....shading.builder import Value, constant
from ..geometry.attributes import AttributeSource
from .reader import Converter, GraphReader, NodeView

#: Operations of the spaces of the node Normal Map. Those of old files have two components the other way.
SPACES = {
    "OBJECT": "normal_map_object",
    "WORLD": "normal_map_world",
    "BLENDER_OBJECT": "normal_map_object",
    "BLENDER_WORLD": "normal_map_world",
}

#: Pixels over which Cycles takes differences of heights. Blender 4.3 made it an input, whose default displacement has.
WHOLE_PIXEL = 1.0
DISPLACEMENT_FILTER_WIDTH = WHOLE_PIXEL if bpy.app.version < (4, 3) else 0.1


def bump(view: NodeView) -> Mapping[str, Value]:
    """Bump."""
    distance = view.value("Distance")
    if view.node.invert:
        distance = view.call("math_multiply", distance, constant(-1.0))
    operands = view.value("Strength"), distance, view.value("Height"), view.call("geometry_position")
    socket, normal = view.socket("Filter Width"), view.value("Normal", view.reader.normal())
    width = constant(WHOLE_PIXEL if socket is None else socket.default_value)
    return {"Normal": view.call("bump", *operands, normal, width)}


def normal_map(view: NodeView) -> Mapping[str, Value]:
    """Normal Map."""
    node, color, strength = view.node, view.value("Color"), view.value("Strength")
    if getattr(node, "convention", "OPENGL") == "DIRECTX":
        color = view.call("vector_multiply_add", color, constant((1.0, -1.0, 1.0)), constant((0.0, 1.0, 0.0)))
    if node.space == "TANGENT":
        tangent = view.reader.attribute(AttributeSource.TANGENT, node.uv_map)
        return {"Normal": view.call("normal_map_tangent", strength, color, tangent)}
    if node.space.startswith("BLENDER"):
        color = view.call("vector_multiply_add", color, constant((1.0, -1.0, -1.0)), constant((0.0, 1.0, 1.0)))
    return {"Normal": view.call(SPACES[node.space], strength, color)}


def displacement(view: NodeView) -> Mapping[str, Value]:
    """Displacement along the normal."""
    height = view.call("math_subtract", view.value("Height"), view.value("Midlevel"))
    height, normal = view.call("math_multiply", height, view.value("Scale")), view.call("geometry_normal")
    if view.node.space == "WORLD":
        return {"Displacement": view.call("vector_scale", normal, height)}
    offset = view.call("vector_scale", view.call("coordinate_normal"), height)
    return {"Displacement": view.call("world_from_object_vector", offset)}


def displaced_normal(reader: GraphReader, output: bpy.types.Node) -> Value | None:
    """The normal of a surface with displacement, from the material's output node; None without displacement."""
    socket = output.inputs["Displacement"]
    if not socket.is_linked:
        return None
    reader.convert(socket)
    call = reader.builder.call
    one, position, normal = constant(1.0), call("geometry_position"), call("geometry_normal")
    height = call("vector_dot_product", reader.value((), socket), normal)
    return call("bump", one, one, height, position, normal, constant(DISPLACEMENT_FILTER_WIDTH))


CONVERTERS: dict[str, Converter] = {
    "ShaderNodeBump": bump,
    "ShaderNodeNormalMap": normal_map,
    "ShaderNodeDisplacement": displacement,
}
