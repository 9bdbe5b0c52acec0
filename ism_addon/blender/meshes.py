# SPDX-License-Identifier: GPL-3.0-or-later
"""One evaluated mesh to triangles, read with foreach_get; what no triangle can be made of is counted and left out."""

from dataclasses import dataclass

import bpy
import numpy as np

from ..ranges import within
from ..scene import Mesh
from . import faces


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
    positions = faces.read(source.attributes["position"].data, "vector", (len(source.vertices), 3))
    triangles, reached = faces.triangles(source, positions), within(positions)
    reachable = np.ones(len(triangles.vertices), np.bool_)
    if not reached.all():
        reachable = reached.all(1)[triangles.vertices].all(1)
    kept = reachable & triangles.has_area
    mesh = _mesh(source, positions, triangles, kept, materials) if kept.any() else None
    return Reading(mesh, int((reachable & ~kept).sum()), int((~reachable).sum()))


def _mesh(
    source: bpy.types.Mesh,
    positions: np.ndarray,
    triangles: faces.Triangles,
    kept: np.ndarray,
    materials: tuple[int, ...],
) -> Mesh:
    """The kept triangles, with the vertices that they use: others may be no numbers, or far away."""
    vertices, corners = triangles.vertices, triangles.corners
    of_triangles, uvs = _materials(source, materials), _uvs(source)
    normals = _normals(source, vertices, corners)
    if not kept.all():
        vertices, corners, of_triangles = vertices[kept], corners[kept], of_triangles[kept]
        normals = normals[kept] if normals.ndim == 3 else normals
    used = np.zeros(len(positions), np.bool_)
    used[vertices] = True
    if not used.all():
        normals = normals[used] if normals.ndim == 2 else normals
        positions, vertices = positions[used], (np.cumsum(used, dtype=np.uint32) - np.uint32(1))[vertices]
    return Mesh(
        positions=positions,
        triangles=vertices,
        normals=_mended(normals, positions, vertices),
        uvs=np.zeros((0, 3, 2), np.float32) if uvs is None else uvs[corners],
        materials=of_triangles,
    )


def _normals(source: bpy.types.Mesh, vertices: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(V,3) where all faces at a vertex have the same, else (T,3,3)."""
    if source.normals_domain == "POINT":
        return faces.read(source.vertex_normals, "vector", (len(source.vertices), 3))
    if source.normals_domain == "FACE":
        normals = faces.read(source.polygon_normals, "vector", (len(source.polygons), 3))
        return np.broadcast_to(normals[faces.face_of_each(source)][:, None], (*vertices.shape, 3))
    return faces.read(source.corner_normals, "vector", (len(source.loops), 3))[corners]


def _mended(normals: np.ndarray, positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The same of unit length, but where they are no directions, those of their triangles."""
    with np.errstate(all="ignore"):
        x, y, z = (normals[..., axis] for axis in range(3))
        square = x * x + y * y + z * z
    uneven = ~(np.abs(square - 1.0) < 0.01)
    if not uneven.any():
        return normals
    broken = uneven & ~((square > 0.25) & np.isfinite(square))
    with np.errstate(all="ignore"):
        normals = np.where(uneven[..., None], normals / np.sqrt(square)[..., None], normals)
    if not broken.any():
        return normals
    if normals.ndim == 2:
        normals, broken = normals[triangles], broken[triangles]
    of_triangle, _ = np.nonzero(broken)
    a, b, c = (positions[triangles[of_triangle, corner]] for corner in range(3))
    crossed = np.cross(b - a, c - a)
    normals[broken] = crossed / np.linalg.norm(crossed, axis=1, keepdims=True)
    return normals


def _uvs(source: bpy.types.Mesh) -> np.ndarray | None:
    """(corners, 2) of the layer that renders, what is not finite at zero."""
    layers = source.uv_layers
    layer = next((layer for layer in layers if layer.active_render), layers[0] if len(layers) else None)
    if layer is None:
        return None
    uvs = faces.read(layer.uv, "vector", (len(source.loops), 2))
    return np.nan_to_num(uvs, copy=False, nan=0.0, posinf=0.0, neginf=0.0)


def _materials(source: bpy.types.Mesh, materials: tuple[int, ...]) -> np.ndarray:
    """(T,) uint32: the material of each triangle, into Materials."""
    slots, count = source.attributes.get("material_index"), len(source.loops) - 2 * len(source.polygons)
    if slots is None or len(materials) == 1:
        return np.broadcast_to(np.uint32(materials[0]), count)
    slots = np.clip(faces.read(slots.data, "value", len(source.polygons), np.int32), 0, len(materials) - 1)
    return np.array(materials, np.uint32)[slots][faces.face_of_each(source)]
