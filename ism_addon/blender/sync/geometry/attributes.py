# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads what graphs need of a mesh at each corner: UV maps, colors and other attributes, and generated coordinates."""

from enum import Enum
from typing import NamedTuple

import bpy
import numpy as np

from . import triangulate


class AttributeSource(Enum):
    """Where the numbers of an attribute come from."""

    UV = "UV map"
    NAMED = "attribute of the mesh"
    NUMBER = "attribute of the mesh as one number"
    COLOR = "color attribute; without a name, the one that renders"
    GENERATED = "position in the mesh's texture space, before modifiers"
    TANGENT = "tangent of a UV map, and in the fourth number the side of the bitangent"


class Attribute(NamedTuple):
    """An attribute that a material reads."""

    source: AttributeSource
    name: str = ""


#: Properties of an attribute's items by its type, and the numbers of each.
PROPERTIES = {
    "FLOAT": ("value", 1),
    "INT": ("value", 1),
    "INT8": ("value", 1),
    "BOOLEAN": ("value", 1),
    "FLOAT2": ("vector", 2),
    "FLOAT_VECTOR": ("vector", 3),
    "FLOAT_COLOR": ("color", 4),
    "BYTE_COLOR": ("color", 4),
    "QUATERNION": ("value", 4),
}
#: numpy's types of those that are not float32.
DTYPES = {"INT": np.int32, "INT8": np.int32, "BOOLEAN": np.bool_}


def read(source: bpy.types.Mesh, attributes: tuple[tuple[Attribute, ...], ...]) -> np.ndarray | None:
    """(L,A,4) float32 at the corners of an evaluated mesh; None if no slot needs any. `attributes`: of each slot."""
    count = max(map(len, attributes), default=0)
    if not count:
        return None
    values = {each: corners_of(source, each) for each in dict.fromkeys(each for slot in attributes for each in slot)}
    if len(set(attributes)) == 1:
        return np.stack([values[each] for each in attributes[0]], 1)
    result = np.zeros((len(source.loops), count, 4), np.float32)
    corner_slots = slots_of_corners(source, len(attributes))
    for slot, wanted in enumerate(attributes):
        chosen = corner_slots == slot
        for position, each in enumerate(wanted):
            result[chosen, position] = values[each][chosen]
    return result


def slots_of_corners(source: bpy.types.Mesh, slots: int) -> np.ndarray:
    """(L,) the material slot of each corner."""
    faces, stored = len(source.polygons), source.attributes.get("material_index")
    face_slots = (
        np.zeros(faces, np.int32) if stored is None else triangulate.read(stored.data, "value", faces, np.int32)
    )
    sides = triangulate.read(source.polygons, "loop_total", faces, np.int32)
    return np.repeat(np.clip(face_slots, 0, slots - 1), sides)


def corners_of(source: bpy.types.Mesh, attribute: Attribute) -> np.ndarray:
    """(L,4) float32: an attribute at each corner; if the mesh has none, zero, and named ones are opaque."""
    origin, name = attribute
    if origin is AttributeSource.GENERATED:
        return generated(source)
    if origin is AttributeSource.TANGENT:
        return tangents(source, name)
    if origin is AttributeSource.UV:
        layers = source.uv_layers
        layer = layers.get(name) if name else next((each for each in layers if each.active_render), None)
        stored = None if layer is None else source.attributes.get(layer.name)
    elif origin is AttributeSource.COLOR and not name:
        index = source.color_attributes.render_color_index
        stored = source.color_attributes[index] if 0 <= index < len(source.color_attributes) else None
    else:
        stored = source.attributes.get(name)
    if stored is None or stored.data_type not in PROPERTIES:
        result = np.zeros((len(source.loops), 4), np.float32)
        result[:, 3] = origin is AttributeSource.NAMED
        return result
    result = finite(at_corners(source, stored))
    if origin is AttributeSource.NUMBER:  # Cycles takes the mean of all components, but the first of two
        components = 1 if stored.data_type == "FLOAT2" else 3
        result[:, :3] = result[:, :components].mean(1, keepdims=True)
    return result


def at_corners(source: bpy.types.Mesh, stored: bpy.types.Attribute) -> np.ndarray:
    """(L,4) float32: a stored attribute of one of PROPERTIES' types."""
    four = four_numbers(stored)
    if stored.domain == "CORNER":
        return four
    if stored.domain == "FACE":
        return four.repeat(triangulate.read(source.polygons, "loop_total", len(source.polygons), np.int32), 0)
    if stored.domain == "EDGE":
        four = at_vertices(source, four, stored.data_type)
    return four[triangulate.read(source.attributes[".corner_vert"].data, "value", len(source.loops), np.int32)]


def four_numbers(stored: bpy.types.Attribute) -> np.ndarray:
    """(N,4) float32: an attribute of one of PROPERTIES' types. Numbers are grey, and what is no color is opaque."""
    property_name, size = PROPERTIES[stored.data_type]
    shape = len(stored.data), size
    values = triangulate.read(stored.data, property_name, shape, DTYPES.get(stored.data_type, np.float32))
    four = np.zeros((len(values), 4), np.float32)
    four[:, 3] = 1.0
    four[:, : 3 if size == 1 else size] = values
    return four


def at_vertices(source: bpy.types.Mesh, four: np.ndarray, data_type: str) -> np.ndarray:
    """(V,4) float32 of values (E,4) of edges, as Blender converts them: means, or whether any edge has a flag."""
    edges, vertices = len(source.edges), len(source.vertices)
    ends = triangulate.read(source.edges, "vertices", (edges, 2), np.int32).ravel()
    counts = np.maximum(np.bincount(ends, minlength=vertices), 1)
    means = [np.bincount(ends, column.repeat(2), vertices) / counts for column in four.T]
    result = np.stack(means, 1).astype(np.float32)
    if data_type == "BOOLEAN":
        return np.ceil(result)
    return np.sign(result) * np.floor(np.abs(result) + 0.5) if data_type in DTYPES else result


def generated(source: bpy.types.Mesh) -> np.ndarray:
    """(L,4): positions before modifiers, from 0 to 1 in the mesh's texture space."""
    vertices, corners = len(source.vertices), len(source.loops)
    positions = triangulate.read(source.vertices, "undeformed_co", (vertices, 3))
    size = np.array(source.texspace_size, np.float32)
    scaled = (positions - np.array(source.texspace_location, np.float32)) / np.where(size, 2.0 * size, 1.0) + 0.5
    four = np.concatenate([scaled, np.ones((vertices, 1), np.float32)], 1)
    return finite(four[triangulate.read(source.attributes[".corner_vert"].data, "value", corners, np.int32)])


def tangents(source: bpy.types.Mesh, layer: str) -> np.ndarray:
    """(L,4): tangents of a UV map, and the sign of the bitangent, as Cycles computes them (MikkTSpace)."""
    corners = len(source.loops)
    names = [each.name for each in source.uv_layers if each.name == layer or (not layer and each.active_render)]
    result = np.zeros((corners, 4), np.float32)
    sides = triangulate.read(source.polygons, "loop_total", len(source.polygons), np.int32)
    if not names or sides.max(initial=0) > 4:
        return result
    source.calc_tangents(uvmap=names[0])
    result[:, :3] = triangulate.read(source.loops, "tangent", (corners, 3))
    result[:, 3] = triangulate.read(source.loops, "bitangent_sign", corners)
    source.free_tangents()
    return finite(result)


def finite(values: np.ndarray) -> np.ndarray:
    """Values with zeros in place of those that are not finite."""
    return np.nan_to_num(values, copy=False, nan=0.0, posinf=0.0, neginf=0.0)
