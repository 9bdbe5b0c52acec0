# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces to triangles, as Blender makes them. Its own are slow to read: where all faces have three corners, or all four,
they are made here."""

from collections.abc import Callable
from dataclasses import dataclass

import bpy
import numpy as np

from ....parallel import parallel_map
from .raw_meshes import Raw

#: Faces at a time: so many stay in a processor's cache.
FACES_AT_A_TIME = 1 << 15

#: Corners of the two triangles of a quad, and of those that do not overlap where these would.
HALVES, OTHER_HALVES = np.array([[0, 1, 2, 0, 2, 3], [0, 1, 3, 1, 2, 3]], np.int32)

#: Arrays (N,) of x, y and z: numpy is slow along short axes.
Vectors = list[np.ndarray]


@dataclass(frozen=True)
class Triangles:
    """What faces are made into."""

    corners: np.ndarray  # (T,3) int32, into Blender's corners
    vertices: np.ndarray  # (T,3) uint32
    has_area: np.ndarray  # (T,) bool; not where a vertex is no number


def read(
    collection: bpy.types.bpy_prop_collection, attribute: str, shape: tuple[int, ...] | int, dtype: type = np.float32
) -> np.ndarray:
    """An attribute of all items as an array of this shape."""
    array: np.ndarray = np.empty(shape, dtype)
    collection.foreach_get(attribute, array.reshape(-1))
    return array


def triangles(raw: Raw) -> Triangles:
    """Those of a mesh that has faces."""
    vertices, axes = raw.vertices, [np.ascontiguousarray(along) for along in raw.positions.T]
    if raw.sides == 4:
        firsts = np.arange(0, len(vertices), 4, dtype=np.int32)
        return in_portions(firsts, 2, lambda given: of_quads(given, vertices, axes))
    corners = raw.triangles
    if corners is None:
        corners = np.arange(len(vertices), dtype=np.int32).reshape(-1, 3)
    return in_portions(corners, 1, lambda given: of_corners(given, vertices, axes))


def face_of_each(raw: Raw) -> np.ndarray:
    """(T,) int32: the face that each of these triangles is of."""
    if raw.face_of_each is not None:
        return raw.face_of_each
    return np.repeat(np.arange(raw.faces, dtype=np.int32), raw.sides - 2)


def corners_of_every_face(source: bpy.types.Mesh) -> int:
    """3 or 4 where all faces have as many; else 0."""
    corners, count = len(source.loops), len(source.polygons)
    if corners == 3 * count:
        return 3
    if corners != 4 * count:
        return 0
    uneven = read(source.polygons, "loop_start", count, np.int32) != np.arange(0, corners, 4, dtype=np.int32)
    return 0 if uneven.any() else 4


def in_portions(given: np.ndarray, each: int, make: Callable[[np.ndarray], Triangles]) -> Triangles:
    """What `make` makes of all that is given (N,…), `each` triangles of one, by all cores."""
    count = each * len(given)
    found = Triangles(np.empty((count, 3), np.int32), np.empty((count, 3), np.uint32), np.empty(count, np.bool_))

    def fill(first: int) -> None:
        part = slice(each * first, each * (first + FACES_AT_A_TIME))
        with np.errstate(all="ignore"):
            made = make(given[first : first + FACES_AT_A_TIME])
        found.corners[part], found.vertices[part], found.has_area[part] = made.corners, made.vertices, made.has_area

    parallel_map(fill, range(0, len(given), FACES_AT_A_TIME), len(given))
    return found


def of_corners(corners: np.ndarray, vertices: np.ndarray, axes: Vectors) -> Triangles:
    """The triangles that these corners (T,3) are."""
    chosen = vertices.take(corners)
    a, b, c = ([along.take(vertex) for along in axes] for vertex in np.ascontiguousarray(chosen.T))
    normal = crossed(between(a, b), between(a, c))
    return Triangles(corners, chosen, dotted(normal, normal) > 0)


def of_quads(firsts: np.ndarray, vertices: np.ndarray, axes: Vectors) -> Triangles:
    """Two for each quad, by its first corner (N,): on either side of an edge, as Blender wants them."""
    a, b, c, d = ([along.take(vertices.take(firsts + k)) for along in axes] for k in range(4))
    across = between(a, c)
    one, two = crossed(between(a, b), across), crossed(across, between(a, d))
    overlap = dotted(one, two) < 0
    corners = firsts[:, None] + np.where(overlap[:, None], OTHER_HALVES, HALVES)
    has_area = np.stack([dotted(one, one) > 0, dotted(two, two) > 0], 1)
    if overlap.any():
        has_area[overlap] = of_corners(corners[overlap].reshape(-1, 3), vertices, axes).has_area.reshape(-1, 2)
    corners = corners.reshape(-1, 3)
    return Triangles(corners, vertices.take(corners), has_area.ravel())


def between(a: Vectors, b: Vectors) -> Vectors:
    return [to - begin for begin, to in zip(a, b, strict=True)]


def crossed(a: Vectors, b: Vectors) -> Vectors:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dotted(a: Vectors, b: Vectors) -> np.ndarray:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
