# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulates evaluated meshes, small ones together. Invalid triangles are counted and left out."""

from collections.abc import Sequence
from typing import NamedTuple

import bpy
import numpy as np

from ....scene import Mesh
from ....scene.arrays import array_specs
from ....scene.limits import is_within
from . import triangulate
from .attributes import Attribute, slots_of_corners
from .attributes import read as read_attributes
from .raw_meshes import Raw, joined, starts
from .split_normals import split_normals

#: Meshes with at most this many corners are triangulated together: numpy's overhead would dominate for each alone.
MAX_SMALL_MESH_CORNERS = 1 << 12

#: A face counts as planar if the cosine between its normal and those of its triangles is at least this.
PLANAR_COSINE = 1.0 - 1e-6

#: Since this release Cycles shades by normals of corners.
SHADED_BY_CORNER = 5, 2

#: Type of a triangle's material index.
MATERIAL_INDEX = array_specs(Mesh)["materials"].dtype.type

NO_UVS, NO_ATTRIBUTES = (array_specs(Mesh)[name].empty() for name in ("uvs", "attributes"))


class Reading(NamedTuple):
    """A triangulated mesh; None if no triangle is left."""

    mesh: Mesh | None
    without_area: int  # triangles left out
    beyond_limits: int  # triangles left out


def read(
    source: bpy.types.Mesh,
    materials: tuple[int, ...],
    layers: tuple[str | None, ...] = ("",),
    attributes: tuple[tuple[Attribute, ...], ...] = (),
) -> Raw | None:
    """An evaluated mesh; None if it has no faces. `materials`: indices into Materials of its slots, at least one.

    `layers`: the UV layer of each slot, or one for all; "": the one that renders, None: none. `attributes`: others that
    each slot needs. As in Blender, a face whose slot does not exist has the last slot's material.
    """
    corners, count = len(source.loops), len(source.polygons)
    if not count:
        return None
    vertices, sides = len(source.vertices), triangulate.corners_of_every_face(source)
    slots = source.attributes.get("material_index") if len(materials) > 1 else None
    ready, domain = source.loop_triangles, source.normals_domain
    indices = triangulate.read(source.attributes[".corner_vert"].data, "value", corners, np.int32)
    values, length = {
        "POINT": (source.vertex_normals, vertices),
        "FACE": (source.polygon_normals, count),
        "CORNER": (source.corner_normals, corners),
    }[domain]
    normals = triangulate.read(values, "vector", (length, 3))
    if domain == "CORNER" and bpy.app.version < SHADED_BY_CORNER:
        normals = split_normals(source, normals, indices)
    return Raw(
        positions=triangulate.read(source.attributes["position"].data, "vector", (vertices, 3)),
        vertices=indices.view(np.uint32),
        faces=count,
        sides=sides,
        triangles=None if sides else triangulate.read(ready, "loops", (len(ready), 3), np.int32),
        triangle_face=None if sides else triangulate.read(source.loop_triangle_polygons, "value", len(ready), np.int32),
        domain=domain,
        normals=normals,
        flat=_flat(source, sides),
        slots=None if slots is None else triangulate.read(slots.data, "value", count, np.int32),
        uvs=_uvs(source, layers),
        materials=materials,
        attributes=read_attributes(source, attributes),
    )


def triangulated(raws: Sequence[Raw]) -> list[Reading]:
    """The triangles of some meshes. Small meshes of the same layout are processed together."""
    groups: dict[tuple, list[int]] = {}
    for index, raw in enumerate(raws):
        groups.setdefault(raw.layout if len(raw.vertices) <= MAX_SMALL_MESH_CORNERS else (index,), []).append(index)
    readings: dict[int, Reading] = {}
    for indices in groups.values():
        readings.update(zip(indices, _triangulated([raws[index] for index in indices]), strict=True))
    return [readings[index] for index in range(len(raws))]


def _triangulated(raws: list[Raw]) -> list[Reading]:
    """The triangles of meshes of the same layout."""
    raw, triangle_counts = joined(raws), [each.triangle_count for each in raws]
    triangles, vertices_within = triangulate.triangles(raw), is_within(raw.positions)
    within = np.ones(len(triangles.vertices), np.bool_)
    if not vertices_within.all():
        within &= vertices_within.all(1).take(triangles.vertices).all(1)
    kept = within & triangles.has_area
    positions, vertices, corners = raw.positions, triangles.vertices, triangles.corners
    materials, normals = _materials(raw), _normals(raw, vertices, corners)
    if not kept.all():
        vertices, corners, materials = vertices[kept], corners[kept], materials[kept]
        normals = normals[kept] if normals.ndim == 3 else normals
    used = np.zeros(len(positions), np.bool_)  # others may be invalid
    used[vertices] = True
    if not used.all():
        normals = normals[used] if normals.ndim == 2 else normals
        positions, vertices = positions[used], (np.cumsum(used, dtype=np.uint32) - np.uint32(1))[vertices]
    repaired = _repaired(normals, positions, vertices)
    if repaired.ndim != normals.ndim and len(raws) > 1:
        return [_triangulated([each])[0] for each in raws]  # some can keep normals by vertex
    uvs = NO_UVS if raw.uvs is None else _finite(raw.uvs)[corners]
    others = NO_ATTRIBUTES if raw.attributes is None else raw.attributes[corners]
    combined = Mesh.of(
        positions=positions, triangles=vertices, normals=repaired, uvs=uvs, materials=materials, attributes=others
    )
    lengths = counted(used, [len(each.positions) for each in raws]), counted(kept, triangle_counts)
    meshes = [combined if len(vertices) else None] if len(raws) == 1 else _split(combined, *lengths)
    without_area, beyond_limits = counted(within & ~kept, triangle_counts), counted(~within, triangle_counts)
    return [Reading(*each) for each in zip(meshes, without_area, beyond_limits, strict=True)]


def counted(chosen: np.ndarray, lengths: Sequence[int]) -> list[int]:
    """How many are chosen, of (N,) bool, in each of consecutive segments of these lengths."""
    if len(lengths) == 1:
        return [int(np.count_nonzero(chosen))]
    return np.bincount(np.arange(len(lengths)).repeat(lengths)[chosen], minlength=len(lengths)).tolist()


def _split(combined: Mesh, vertices: list[int], triangles: list[int]) -> list[Mesh | None]:
    """The meshes that were joined, by their numbers of vertices and triangles: views of the joined arrays."""
    first = starts(vertices).astype(np.uint32).repeat(triangles)[:, None]
    local, by_vertex, meshes = combined.triangles - first, combined.normals.ndim == 2, []
    ranges = zip(starts(vertices).tolist(), vertices, starts(triangles).tolist(), triangles, strict=True)
    for vertex, vertex_count, triangle, triangle_count in ranges:
        v, t = slice(vertex, vertex + vertex_count), slice(triangle, triangle + triangle_count)
        normals, uvs = combined.normals[v if by_vertex else t], combined.uvs[t]
        arrays = combined.positions[v], local[t], normals, uvs, combined.materials[t], combined.attributes[t]
        meshes.append(Mesh(*arrays) if triangle_count else None)
    return meshes


def _normals(raw: Raw, vertices: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(V,3) if all faces at a vertex share its normal, else (T,3,3)."""
    if raw.domain == "POINT":
        return raw.normals
    if raw.domain == "FACE":
        normals = np.broadcast_to(raw.normals[triangulate.triangle_face(raw)][:, None], (*vertices.shape, 3))
    else:
        normals = raw.normals[corners]
    if raw.flat is None:
        return normals
    return _nonplanar_normals(normals, raw.flat[triangulate.triangle_face(raw)], raw.positions, vertices)


def _flat(source: bpy.types.Mesh, sides: int) -> np.ndarray | None:
    """(F,) bool: flat-shaded faces; None if flat faces are shaded by their face normal."""
    if source.normals_domain == "CORNER" and bpy.app.version >= SHADED_BY_CORNER:
        return None
    sharp = source.attributes.get("sharp_face")
    if sharp is None or source.normals_domain == "POINT" or source.has_custom_normals or sides == 3:
        return None
    return triangulate.read(sharp.data, "value", len(source.polygons), np.bool_)


def _nonplanar_normals(
    normals: np.ndarray, flat: np.ndarray, positions: np.ndarray, triangles: np.ndarray
) -> np.ndarray:
    """Normals (T,3,3), replaced by triangle normals on flat faces that are not planar, as Blender shades them."""
    axes = [np.ascontiguousarray(along) for along in positions.T]
    a, b, c = ([along.take(vertex) for along in axes] for vertex in np.ascontiguousarray(triangles.T))
    with np.errstate(all="ignore"):
        triangle_normals = np.stack(triangulate.cross(triangulate.difference(a, b), triangulate.difference(a, c)), 1)
        triangle_normals /= np.linalg.norm(triangle_normals, axis=1)[:, None]
        nonplanar = flat & (np.einsum("tk,tk->t", triangle_normals, normals[:, 0]) < PLANAR_COSINE)
    if not nonplanar.any():
        return normals
    normals = normals.copy()
    normals[nonplanar] = triangle_normals[nonplanar][:, None]
    return normals


def _repaired(normals: np.ndarray, positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Normals of unit length; triangle normals where they are not directions."""
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
    triangle_normals = np.cross(b - a, c - a)
    normals[broken] = triangle_normals / np.linalg.norm(triangle_normals, axis=1, keepdims=True)
    return normals


def _uvs(source: bpy.types.Mesh, layers: tuple[str | None, ...]) -> np.ndarray | None:
    """(L,2) of each slot's layer; as in Cycles, zero if there is no such layer. None if no slot needs UVs."""
    needed = [name for name in layers if name is not None]
    if not needed or not len(source.uv_layers):
        return None
    layer_uvs = {name: _layer(source, name) for name in dict.fromkeys(needed)}
    if len(layer_uvs) == 1:
        return layer_uvs[needed[0]]
    corner_slots = slots_of_corners(source, len(layers))
    return np.stack([layer_uvs[needed[0] if name is None else name] for name in layers])[
        corner_slots, np.arange(len(source.loops))
    ]


def _layer(source: bpy.types.Mesh, name: str) -> np.ndarray:
    """(L,2) of a layer by name; "": the one that renders."""
    layers = source.uv_layers
    chosen = layers.get(name) if name else next((layer for layer in layers if layer.active_render), layers[0])
    if chosen is None:
        return np.zeros((len(source.loops), 2), np.float32)
    return triangulate.read(chosen.uv, "vector", (len(source.loops), 2))


def _finite(uvs: np.ndarray) -> np.ndarray:
    """UVs with zeros in place of values that are not finite."""
    return np.nan_to_num(uvs, copy=False, nan=0.0, posinf=0.0, neginf=0.0)


def _materials(raw: Raw) -> np.ndarray:
    """(T,) uint32: the material index of each triangle, into Materials."""
    if raw.slots is None:
        return np.broadcast_to(MATERIAL_INDEX(raw.materials[0]), raw.triangle_count)
    return np.array(raw.materials, MATERIAL_INDEX)[raw.slots][triangulate.triangle_face(raw)]
