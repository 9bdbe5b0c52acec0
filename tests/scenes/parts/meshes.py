# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender meshes of shapes."""

import math
from collections.abc import Sequence

import bmesh
import bpy
import numpy as np

from tests.scenes.parts.materials import Materials, texture_size
from tests.scenes.parts.shapes import Shape

SHARP = math.radians(32.0)  # edges with a larger angle between their faces are shaded sharp
WELD_DISTANCE = 1e-5  # m


def mesh_of(name: str, parts: Sequence[tuple[Shape, str]], materials: Materials) -> bpy.types.Mesh:
    """One mesh of several (shape, material): vertices welded, normals outwards, smooth except at sharp edges."""
    positions, quads, uvs, slots, offset = [], [], [], [], 0
    for slot, (shape, material) in enumerate(parts):
        positions.append(shape.positions)
        quads.append(shape.quads + offset)
        uvs.append(shape.uvs / texture_size(material))
        slots.append(np.full(len(shape.quads), slot, np.int32))
        offset += len(shape.positions)
    points, faces = weld(np.concatenate(positions), np.concatenate(quads))
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    for _, material in parts:
        mesh.materials.append(materials[material])
    mesh.polygons.foreach_set("material_index", np.concatenate(slots))
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", np.concatenate(uvs).astype(np.float32).ravel())
    face_outwards(mesh)
    mesh.shade_smooth()
    mesh.set_sharp_from_angle(angle=SHARP)
    return mesh


def weld(positions: np.ndarray, quads: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Merge points at the same position."""
    _, first, inverse = np.unique(
        np.round(positions / WELD_DISTANCE).astype(np.int64), axis=0, return_index=True, return_inverse=True
    )
    return positions[first], inverse.reshape(-1)[quads]


def face_outwards(mesh: bpy.types.Mesh) -> None:
    """Make the normals of closed surfaces point out."""
    work = bmesh.new()
    work.from_mesh(mesh)
    bmesh.ops.recalc_face_normals(work, faces=work.faces)
    work.to_mesh(mesh)
    work.free()
