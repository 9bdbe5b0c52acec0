# SPDX-License-Identifier: GPL-3.0-or-later
"""One evaluated mesh to triangles, read with foreach_get; what no triangle can be made of is counted and left out."""

from dataclasses import dataclass

import bpy
import numpy as np

from ..ranges import within
from ..scene import Mesh
from . import faces

#: The cosine between a face's normal and its triangles' where it is as good as plane.
PLANE = 1.0 - 1e-6


@dataclass(frozen=True)
class Reading:
    """What was read of a mesh: None where no triangle is left."""

    mesh: Mesh | None
    without_area: int  # triangles left out
    out_of_reach: int  # triangles left out


def read(source: bpy.types.Mesh, materials: tuple[int, ...], layers: tuple[str, ...] = ("",)) -> Reading:
    """A mesh as it is evaluated; `materials` are the indices into Materials of its slots, one at least.

    `layers` are the UV layers that these want, "" for the one that renders; one alone is all slots'.
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
    mesh = _mesh(source, positions, triangles, kept, materials, layers) if kept.any() else None
    return Reading(mesh, int((reachable & ~kept).sum()), int((~reachable).sum()))


def _mesh(
    source: bpy.types.Mesh,
    positions: np.ndarray,
    triangles: faces.Triangles,
    kept: np.ndarray,
    materials: tuple[int, ...],
    layers: tuple[str, ...],
) -> Mesh:
    """The kept triangles, with the vertices that they use: others may be no numbers, or far away."""
    vertices, corners = triangles.vertices, triangles.corners
    of_triangles, uvs = _materials(source, materials), _uvs(source, layers)
    normals = _normals(source, positions, vertices, corners)
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


def _normals(source: bpy.types.Mesh, positions: np.ndarray, vertices: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(V,3) where all faces at a vertex have the same, else (T,3,3)."""
    if source.normals_domain == "POINT":
        return faces.read(source.vertex_normals, "vector", (len(source.vertices), 3))
    if source.normals_domain == "FACE":
        normals = faces.read(source.polygon_normals, "vector", (len(source.polygons), 3))
        normals = np.broadcast_to(normals[faces.face_of_each(source)][:, None], (*vertices.shape, 3))
    else:
        normals = faces.read(source.corner_normals, "vector", (len(source.loops), 3))[corners]
    flat = _flat(source)
    return normals if flat is None else _bent(normals, flat, positions, vertices)


def _flat(source: bpy.types.Mesh) -> np.ndarray | None:
    """(T,) bool: the triangles of faces that are shaded flat; None where their normals are those of their faces."""
    sharp = source.attributes.get("sharp_face")
    if source.normals_domain == "CORNER" and bpy.app.version >= (5, 2):
        return None  # Cycles shades corners by their own normals since then
    if sharp is None or source.has_custom_normals or faces.corners_of_every_face(source) == 3:
        return None
    return faces.read(sharp.data, "value", len(source.polygons), np.bool_)[faces.face_of_each(source)]


def _bent(normals: np.ndarray, flat: np.ndarray, positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Normals (T,3,3), but where a flat face is not plane, those of its triangles, which Blender shades it with."""
    axes = [np.ascontiguousarray(along) for along in positions.T]
    a, b, c = ([along.take(vertex) for along in axes] for vertex in np.ascontiguousarray(triangles.T))
    with np.errstate(all="ignore"):
        crossed = np.stack(faces.crossed(faces.between(a, b), faces.between(a, c)), 1)
        crossed /= np.linalg.norm(crossed, axis=1)[:, None]
        bent = flat & (np.einsum("tk,tk->t", crossed, normals[:, 0]) < PLANE)
    if not bent.any():
        return normals
    normals = normals.copy()
    normals[bent] = crossed[bent][:, None]
    return normals


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


def _uvs(source: bpy.types.Mesh, layers: tuple[str, ...]) -> np.ndarray | None:
    """(corners, 2) of each slot's layer, what is not finite at zero, and as in Cycles what has no such layer."""
    if not len(source.uv_layers):
        return None
    of_layer = {name: _layer(source, name) for name in layers}
    if len(of_layer) == 1:
        return of_layer[layers[0]]
    uvs, slots = np.stack([of_layer[name] for name in layers]), _slots(source, len(layers))
    of_corners = np.repeat(slots, faces.read(source.polygons, "loop_total", len(source.polygons), np.int32))
    return uvs[of_corners, np.arange(len(source.loops))]


def _layer(source: bpy.types.Mesh, name: str) -> np.ndarray:
    """(corners, 2) of the layer of a name, "" for the one that renders."""
    layers = source.uv_layers
    chosen = layers.get(name) if name else next((layer for layer in layers if layer.active_render), layers[0])
    if chosen is None:
        return np.zeros((len(source.loops), 2), np.float32)
    uvs = faces.read(chosen.uv, "vector", (len(source.loops), 2))
    return np.nan_to_num(uvs, copy=False, nan=0.0, posinf=0.0, neginf=0.0)


def _materials(source: bpy.types.Mesh, materials: tuple[int, ...]) -> np.ndarray:
    """(T,) uint32: the material of each triangle, into Materials."""
    if len(materials) == 1 or source.attributes.get("material_index") is None:
        return np.broadcast_to(np.uint32(materials[0]), len(source.loops) - 2 * len(source.polygons))
    return np.array(materials, np.uint32)[_slots(source, len(materials))][faces.face_of_each(source)]


def _slots(source: bpy.types.Mesh, count: int) -> np.ndarray:
    """(faces,) the slot of each, of so many."""
    slots = source.attributes.get("material_index")
    if slots is None:
        return np.zeros(len(source.polygons), np.int32)
    return np.clip(faces.read(slots.data, "value", len(source.polygons), np.int32), 0, count - 1)
