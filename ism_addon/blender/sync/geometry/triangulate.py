# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulates faces as Blender does. Blender's triangles are slow to read, so meshes that have only triangles or only
quads are triangulated here."""

from collections.abc import Callable
from dataclasses import dataclass

import bpy
import numpy as np

from ....parallel import parallel_map
from .raw_meshes import Raw

#: Faces that are triangulated at a time: few enough for the processor's cache.
FACES_AT_A_TIME = 1 << 15

#: Corners of the two triangles of a quad: split along the first diagonal, or the other one if they would overlap then.
FIRST_DIAGONAL, OTHER_DIAGONAL = np.array([[0, 1, 2, 0, 2, 3], [0, 1, 3, 1, 2, 3]], np.int32)

#: Arrays (N,) of x, y and z: numpy is slow along short axes.
Vectors = list[np.ndarray]


@dataclass(frozen=True)
class Triangles:
    """The triangles of faces."""

    corners: np.ndarray  # (T,3) int32, into Blender's corners
    vertices: np.ndarray  # (T,3) uint32
    has_area: np.ndarray  # (T,) bool; False if a position is NaN


def read(
    collection: bpy.types.bpy_prop_collection, attribute: str, shape: tuple[int, ...] | int, dtype: type = np.float32
) -> np.ndarray:
    """An attribute of all items as an array of this shape."""
    array: np.ndarray = np.empty(shape, dtype)
    collection.foreach_get(attribute, array.reshape(-1))
    return array


def triangles(raw: Raw) -> Triangles:
    """The triangles of a mesh that has faces."""
    vertices, axes = raw.vertices, [np.ascontiguousarray(along) for along in raw.positions.T]
    if raw.sides == 4:
        first_corners = np.arange(0, len(vertices), 4, dtype=np.int32)
        return in_portions(first_corners, 2, lambda portion: of_quads(portion, vertices, axes))
    corners = raw.triangles
    if corners is None:
        corners = np.arange(len(vertices), dtype=np.int32).reshape(-1, 3)
    return in_portions(corners, 1, lambda portion: of_corners(portion, vertices, axes))


def triangle_face(raw: Raw) -> np.ndarray:
    """(T,) int32: the face of each triangle."""
    if raw.triangle_face is not None:
        return raw.triangle_face
    return np.repeat(np.arange(raw.faces, dtype=np.int32), raw.sides - 2)


def corners_of_every_face(source: bpy.types.Mesh) -> int:
    """3 or 4 if all faces have that many corners, else 0."""
    corners, count = len(source.loops), len(source.polygons)
    if corners == 3 * count:
        return 3
    if corners != 4 * count:
        return 0
    uneven = read(source.polygons, "loop_start", count, np.int32) != np.arange(0, corners, 4, dtype=np.int32)
    return 0 if uneven.any() else 4


def in_portions(faces: np.ndarray, per_face: int, make: Callable[[np.ndarray], Triangles]) -> Triangles:
    """Apply `make`, which gives `per_face` triangles for each face, to portions of faces (N,…) on all cores."""
    count = per_face * len(faces)
    result = Triangles(np.empty((count, 3), np.int32), np.empty((count, 3), np.uint32), np.empty(count, np.bool_))

    def fill(first: int) -> None:
        rows = slice(per_face * first, per_face * (first + FACES_AT_A_TIME))
        with np.errstate(all="ignore"):
            new = make(faces[first : first + FACES_AT_A_TIME])
        result.corners[rows], result.vertices[rows], result.has_area[rows] = new.corners, new.vertices, new.has_area

    parallel_map(fill, range(0, len(faces), FACES_AT_A_TIME), len(faces))
    return result


def of_corners(corners: np.ndarray, vertices: np.ndarray, axes: Vectors) -> Triangles:
    """The triangles of corners (T,3)."""
    chosen = vertices.take(corners)
    a, b, c = ([along.take(vertex) for along in axes] for vertex in np.ascontiguousarray(chosen.T))
    normal = cross(difference(a, b), difference(a, c))
    return Triangles(corners, chosen, dot(normal, normal) > 0)


def of_quads(first_corners: np.ndarray, vertices: np.ndarray, axes: Vectors) -> Triangles:
    """Two triangles for each quad, given by its first corner (N,), split as Blender does."""
    a, b, c, d = ([along.take(vertices.take(first_corners + k)) for along in axes] for k in range(4))
    diagonal = difference(a, c)
    first, second = cross(difference(a, b), diagonal), cross(diagonal, difference(a, d))
    overlap = dot(first, second) < 0
    corners = first_corners[:, None] + np.where(overlap[:, None], OTHER_DIAGONAL, FIRST_DIAGONAL)
    has_area = np.stack([dot(first, first) > 0, dot(second, second) > 0], 1)
    if overlap.any():
        has_area[overlap] = of_corners(corners[overlap].reshape(-1, 3), vertices, axes).has_area.reshape(-1, 2)
    corners = corners.reshape(-1, 3)
    return Triangles(corners, vertices.take(corners), has_area.ravel())


def difference(a: Vectors, b: Vectors) -> Vectors:
    return [to - begin for begin, to in zip(a, b, strict=True)]


def cross(a: Vectors, b: Vectors) -> Vectors:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a: Vectors, b: Vectors) -> np.ndarray:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
