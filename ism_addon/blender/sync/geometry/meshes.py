# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated meshes to triangles, the small ones together; what no triangle can be made of is counted and left out."""

from collections.abc import Sequence
from typing import NamedTuple

import bpy
import numpy as np

from ....scene import Mesh
from ....scene.arrays import array_facts
from ....scene.limits import is_within
from . import triangulate
from .raw_meshes import Raw, joined, starts

#: Meshes of at most so many corners are made together: what numpy does to one takes longer to begin than to do.
SMALL_MESH = 1 << 12

#: The cosine between a face's normal and its triangles' where it is as good as plane.
PLANE = 1.0 - 1e-6

#: The type of a triangle's material.
MATERIAL_INDEX = array_facts(Mesh)["materials"].dtype.type

NO_UVS = array_facts(Mesh)["uvs"].empty()


class Reading(NamedTuple):
    """What was made of a mesh: None where no triangle is left."""

    mesh: Mesh | None
    without_area: int  # triangles left out
    out_of_reach: int  # triangles left out


def read(source: bpy.types.Mesh, materials: tuple[int, ...], layers: tuple[str | None, ...] = ("",)) -> Raw | None:
    """A mesh as it is evaluated; `materials` are the indices into Materials of its slots, one at least.

    `layers` are the UV layers that these want, "" for the one that renders, None for none; one alone is all slots'.
    None where it has no faces. As in Blender, a face whose slot there is not has the last slot's material.
    """
    corners, count = len(source.loops), len(source.polygons)
    if not count:
        return None
    vertices, sides = len(source.vertices), triangulate.corners_of_every_face(source)
    slots = source.attributes.get("material_index") if len(materials) > 1 else None
    ready, domain = source.loop_triangles, source.normals_domain
    normals, length = {
        "POINT": (source.vertex_normals, vertices),
        "FACE": (source.polygon_normals, count),
        "CORNER": (source.corner_normals, corners),
    }[domain]
    return Raw(
        positions=triangulate.read(source.attributes["position"].data, "vector", (vertices, 3)),
        vertices=triangulate.read(source.attributes[".corner_vert"].data, "value", corners, np.int32).view(np.uint32),
        faces=count,
        sides=sides,
        triangles=None if sides else triangulate.read(ready, "loops", (len(ready), 3), np.int32),
        face_of_each=None if sides else triangulate.read(source.loop_triangle_polygons, "value", len(ready), np.int32),
        domain=domain,
        normals=triangulate.read(normals, "vector", (length, 3)),
        flat=_flat(source, sides),
        slots=None if slots is None else triangulate.read(slots.data, "value", count, np.int32),
        uvs=_uvs(source, layers),
        materials=materials,
    )


def made(raws: Sequence[Raw]) -> list[Reading]:
    """The triangles of some meshes: a small one is made together with all others of its kind."""
    kinds: dict[tuple, list[int]] = {}
    for number, raw in enumerate(raws):
        kinds.setdefault(raw.kind if len(raw.vertices) <= SMALL_MESH else (number,), []).append(number)
    found: dict[int, Reading] = {}
    for numbers in kinds.values():
        found.update(zip(numbers, _made([raws[number] for number in numbers]), strict=True))
    return [found[number] for number in range(len(raws))]


def _made(raws: list[Raw]) -> list[Reading]:
    """Those of meshes of one kind."""
    raw, of_meshes = joined(raws), [each.triangle_count for each in raws]
    triangles, reached = triangulate.triangles(raw), is_within(raw.positions)
    reachable = np.ones(len(triangles.vertices), np.bool_)
    if not reached.all():
        reachable &= reached.all(1).take(triangles.vertices).all(1)
    kept = reachable & triangles.has_area
    positions, vertices, corners = raw.positions, triangles.vertices, triangles.corners
    materials, normals = _materials(raw), _normals(raw, vertices, corners)
    if not kept.all():
        vertices, corners, materials = vertices[kept], corners[kept], materials[kept]
        normals = normals[kept] if normals.ndim == 3 else normals
    used = np.zeros(len(positions), np.bool_)  # others may be no numbers, or far away
    used[vertices] = True
    if not used.all():
        normals = normals[used] if normals.ndim == 2 else normals
        positions, vertices = positions[used], (np.cumsum(used, dtype=np.uint32) - np.uint32(1))[vertices]
    mended = _mended(normals, positions, vertices)
    if mended.ndim != normals.ndim and len(raws) > 1:
        return [_made([each])[0] for each in raws]  # some keep their normals by vertex
    uvs = NO_UVS if raw.uvs is None else _finite(raw.uvs)[corners]
    whole = Mesh.of(positions=positions, triangles=vertices, normals=mended, uvs=uvs, materials=materials)
    lengths = counted(used, [len(each.positions) for each in raws]), counted(kept, of_meshes)
    found = [whole if len(vertices) else None] if len(raws) == 1 else _apart(whole, *lengths)
    without_area, out_of_reach = counted(reachable & ~kept, of_meshes), counted(~reachable, of_meshes)
    return [Reading(*each) for each in zip(found, without_area, out_of_reach, strict=True)]


def counted(chosen: np.ndarray, lengths: Sequence[int]) -> list[int]:
    """How many are chosen (N,) bool in each of the parts of these lengths."""
    if len(lengths) == 1:
        return [int(np.count_nonzero(chosen))]
    return np.bincount(np.arange(len(lengths)).repeat(lengths)[chosen], minlength=len(lengths)).tolist()


def _apart(whole: Mesh, vertices: list[int], triangles: list[int]) -> list[Mesh | None]:
    """The meshes of so many vertices and triangles that are one behind the other: views of its arrays."""
    first = starts(vertices).astype(np.uint32).repeat(triangles)[:, None]
    local, by_vertex, found = whole.triangles - first, whole.normals.ndim == 2, []
    begins = zip(starts(vertices).tolist(), vertices, starts(triangles).tolist(), triangles, strict=True)
    for vertex, of_vertices, triangle, of_triangles in begins:
        v, t = slice(vertex, vertex + of_vertices), slice(triangle, triangle + of_triangles)
        normals, uvs = whole.normals[v if by_vertex else t], whole.uvs[t]
        mesh = Mesh(whole.positions[v], local[t], normals, uvs, whole.materials[t]) if of_triangles else None
        found.append(mesh)
    return found


def _normals(raw: Raw, vertices: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(V,3) where all faces at a vertex have the same, else (T,3,3)."""
    if raw.domain == "POINT":
        return raw.normals
    if raw.domain == "FACE":
        normals = np.broadcast_to(raw.normals[triangulate.face_of_each(raw)][:, None], (*vertices.shape, 3))
    else:
        normals = raw.normals[corners]
    if raw.flat is None:
        return normals
    return _bent(normals, raw.flat[triangulate.face_of_each(raw)], raw.positions, vertices)


def _flat(source: bpy.types.Mesh, sides: int) -> np.ndarray | None:
    """(F,) bool: the faces that are shaded flat; None where their triangles' normals are those of their faces."""
    if source.normals_domain == "CORNER" and bpy.app.version >= (5, 2):
        return None  # Cycles shades corners by their own normals since then
    sharp = source.attributes.get("sharp_face")
    if sharp is None or source.normals_domain == "POINT" or source.has_custom_normals or sides == 3:
        return None
    return triangulate.read(sharp.data, "value", len(source.polygons), np.bool_)


def _bent(normals: np.ndarray, flat: np.ndarray, positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Normals (T,3,3), but where a flat face is not plane, those of its triangles, which Blender shades it with."""
    axes = [np.ascontiguousarray(along) for along in positions.T]
    a, b, c = ([along.take(vertex) for along in axes] for vertex in np.ascontiguousarray(triangles.T))
    with np.errstate(all="ignore"):
        crossed = np.stack(triangulate.crossed(triangulate.between(a, b), triangulate.between(a, c)), 1)
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


def _uvs(source: bpy.types.Mesh, layers: tuple[str | None, ...]) -> np.ndarray | None:
    """(L,2) of each slot's layer, and as in Cycles zero of what has no such layer; None where no slot wants any."""
    wanted = [name for name in layers if name is not None]
    if not wanted or not len(source.uv_layers):
        return None
    of_layer = {name: _layer(source, name) for name in dict.fromkeys(wanted)}
    if len(of_layer) == 1:
        return of_layer[wanted[0]]
    count, slots = len(source.polygons), source.attributes.get("material_index")
    of_faces = np.zeros(count, np.int32) if slots is None else triangulate.read(slots.data, "value", count, np.int32)
    of_faces = np.clip(of_faces, 0, len(layers) - 1)
    of_corners = np.repeat(of_faces, triangulate.read(source.polygons, "loop_total", count, np.int32))
    return np.stack([of_layer[wanted[0] if name is None else name] for name in layers])[
        of_corners, np.arange(len(source.loops))
    ]


def _layer(source: bpy.types.Mesh, name: str) -> np.ndarray:
    """(L,2) of the layer of a name, "" for the one that renders."""
    layers = source.uv_layers
    chosen = layers.get(name) if name else next((layer for layer in layers if layer.active_render), layers[0])
    if chosen is None:
        return np.zeros((len(source.loops), 2), np.float32)
    return triangulate.read(chosen.uv, "vector", (len(source.loops), 2))


def _finite(uvs: np.ndarray) -> np.ndarray:
    """The same, what is not finite at zero."""
    return np.nan_to_num(uvs, copy=False, nan=0.0, posinf=0.0, neginf=0.0)


def _materials(raw: Raw) -> np.ndarray:
    """(T,) uint32: the material of each triangle, into Materials."""
    if raw.slots is None:
        return np.broadcast_to(MATERIAL_INDEX(raw.materials[0]), raw.triangle_count)
    return np.array(raw.materials, MATERIAL_INDEX)[raw.slots][triangulate.face_of_each(raw)]
