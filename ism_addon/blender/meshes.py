# SPDX-License-Identifier: GPL-3.0-or-later
"""One evaluated mesh to triangles, read with foreach_get; what no triangle can be made of is counted and left out."""

from dataclasses import dataclass

import bpy
import numpy as np

from ..scene import Mesh
from .reach import within


@dataclass(frozen=True)
class Reading:
    """What was read of a mesh: None where no triangle is left."""

    mesh: Mesh | None
    without_area: int  # triangles left out
    out_of_reach: int  # triangles left out


def read(source: bpy.types.Mesh, materials: tuple[int, ...]) -> Reading:
    """A mesh as it is evaluated; `materials` are the indices into Materials of its slots, one at least.

    As in Blender, a face whose slot there is not has the last slot's material.
    """
    if not len(source.polygons):
        return Reading(None, 0, 0)
    source.calc_loop_triangles()
    corners = _corners(source)
    corner_vertices = _read(source.attributes[".corner_vert"].data, "value", len(source.loops), np.int32)
    positions = _read(source.attributes["position"].data, "vector", (len(source.vertices), 3))
    triangles = corner_vertices[corners]
    reachable = within(positions).all(1)[triangles].all(1)
    with np.errstate(all="ignore"):
        face_normals, areas = _face_normals(positions, triangles)
    kept = reachable & (areas > 0)
    mesh = _mesh(source, positions, triangles, corners, face_normals, kept, materials) if kept.any() else None
    return Reading(mesh, int((reachable & ~kept).sum()), int((~reachable).sum()))


def _mesh(
    source: bpy.types.Mesh,
    positions: np.ndarray,
    triangles: np.ndarray,
    corners: np.ndarray,
    face_normals: np.ndarray,
    kept: np.ndarray,
    materials: tuple[int, ...],
) -> Mesh:
    """The kept triangles, with the vertices that they use: others may be no numbers, or far away."""
    slots = np.minimum(_material_slots(source), len(materials) - 1)
    normals = _read(source.corner_normals, "vector", (len(source.loops), 3))
    uvs = _uvs(source)
    if not kept.all():
        triangles, corners, face_normals, slots = (a[kept] for a in (triangles, corners, face_normals, slots))
    used = np.zeros(len(positions), np.bool_)
    used[triangles] = True
    if not used.all():
        positions, triangles = positions[used], (np.cumsum(used) - 1)[triangles]
    return Mesh(
        positions=positions,
        triangles=triangles.astype(np.uint32),
        normals=_mended(normals[corners], face_normals),
        uvs=np.zeros((0, 3, 2), np.float32) if uvs is None else uvs[corners],
        materials=np.array(materials, np.uint32)[slots],
    )


def _read(
    collection: bpy.types.bpy_prop_collection, attribute: str, shape: tuple[int, ...] | int, dtype: type = np.float32
) -> np.ndarray:
    """An attribute of all items as an array of this shape."""
    array: np.ndarray = np.empty(shape, dtype)
    collection.foreach_get(attribute, array.reshape(-1))
    return array


def _corners(source: bpy.types.Mesh) -> np.ndarray:
    """(T,3) the corners of each triangle. Blender's own triangles are slow to read: not done where all faces are."""
    count = len(source.loop_triangles)
    if count == len(source.polygons):
        return np.arange(3 * count, dtype=np.int32).reshape(-1, 3)
    return _read(source.loop_triangles, "loops", (count, 3), np.int32)


def _face_normals(positions: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(T,3) unit normals, NaN where there is no area, and (T,) areas m²."""
    a, b, c = (positions[triangles[:, corner]] for corner in range(3))
    crossed = np.cross(b - a, c - a)
    doubled = np.linalg.norm(crossed, axis=1)
    return crossed / doubled[:, None], doubled / 2


def _mended(normals: np.ndarray, face_normals: np.ndarray) -> np.ndarray:
    """(T,3,3) corner normals, those that are no directions replaced by their triangle's own."""
    length = np.linalg.norm(normals, axis=2)
    broken = ~(np.isfinite(length) & (length > 0.5))
    if broken.any():
        normals[broken] = np.broadcast_to(face_normals[:, None], normals.shape)[broken]
    return normals


def _uvs(source: bpy.types.Mesh) -> np.ndarray | None:
    """(corners, 2) of the layer that renders, what is not finite at zero."""
    layers = source.uv_layers
    layer = next((layer for layer in layers if layer.active_render), layers[0] if len(layers) else None)
    if layer is None:
        return None
    uvs = _read(layer.uv, "vector", (len(source.loops), 2))
    return np.nan_to_num(uvs, copy=False, nan=0.0, posinf=0.0, neginf=0.0)


def _material_slots(source: bpy.types.Mesh) -> np.ndarray:
    """(T,) material slot of each triangle."""
    faces = _read(source.loop_triangle_polygons, "value", len(source.loop_triangles), np.int32)
    slots = source.attributes.get("material_index")
    if slots is None:
        return np.zeros_like(faces)
    return np.maximum(_read(slots.data, "value", len(source.polygons), np.int32), 0)[faces]
