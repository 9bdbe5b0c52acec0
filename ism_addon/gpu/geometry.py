# SPDX-License-Identifier: GPL-3.0-or-later
"""The triangles of all meshes on the GPU, one mesh behind the other: one number names a triangle of the scene.

Those of a leaf of the tree lie side by side, so the camera and shadow rays read the same arrays. All is made and
uploaded in portions: what the processor holds of it at a time is small.
"""

from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeVar

import moderngl
import numpy as np

from ..scene import Mesh
from .lattice import Lattice
from .layout import WIDTH, array_texture, octahedron_from_directions, write_array
from .mesh_tree import MeshTree

#: Triangles that are made ready at a time: whole lines of the textures, and little enough for a processor's cache.
PORTION = 8 * WIDTH

#: Portions that are made ready while one is uploaded.
AHEAD = 3

#: Tables hold triangles' numbers as floats, see layout.
MOST_TRIANGLES = 1 << 24

Made = TypeVar("Made")


@dataclass(frozen=True)
class Piece:
    """Some triangles of a mesh."""

    mesh: int
    chosen: np.ndarray | slice


class Order:
    """The triangles of all meshes one behind the other, those of a mesh as its tree wants them if there are trees."""

    def __init__(self, meshes: tuple[Mesh, ...], trees: tuple[MeshTree, ...]):
        self.meshes = meshes
        self.lattices = [tree.lattice for tree in trees] if trees else [Lattice.of(mesh) for mesh in meshes]
        self.orders = [tree.order for tree in trees] if trees else [None] * len(meshes)
        self.first_triangle = np.cumsum([0] + [len(mesh.triangles) for mesh in meshes])
        self.first_vertex = np.cumsum([0] + [len(mesh.positions) for mesh in meshes])

    @property
    def count(self) -> int:
        """Triangles of all meshes."""
        return int(self.first_triangle[-1])

    def pieces(self) -> Iterator[Piece]:
        """All triangles, in pieces that end where a portion does or a mesh."""
        for mesh, (begin, end) in enumerate(pairwise(self.first_triangle)):
            borders = [begin, *range(begin // PORTION * PORTION + PORTION, end, PORTION), end]
            for first, last in pairwise(borders):
                part, order = slice(first - begin, last - begin), self.orders[mesh]
                yield Piece(mesh, part if order is None else order[part])

    def portions(self) -> Iterator[tuple[int, list[Piece]]]:
        """All triangles: the number of the first, and the pieces from there on, PORTION by PORTION."""
        found: dict[int, list[Piece]] = {}
        place = 0
        for piece in self.pieces():
            found.setdefault(place // PORTION * PORTION, []).append(piece)
            place += len(self.triangles(piece))
        yield from found.items()

    def made(self, make: Callable[[int, list[Piece]], Made]) -> Iterator[tuple[int, Made]]:
        """What `make` makes of each portion, by all cores: the number of its first triangle, and that."""
        waiting: deque[tuple[int, Future[Made]]] = deque()
        with ThreadPoolExecutor() as cores:
            for first, pieces in self.portions():
                waiting.append((first, cores.submit(make, first, pieces)))
                if len(waiting) > AHEAD:
                    number, ready = waiting.popleft()
                    yield number, ready.result()
            for number, ready in waiting:
                yield number, ready.result()

    def triangles(self, piece: Piece) -> np.ndarray:
        """(N,3) uint32 into the positions of its mesh."""
        return self.meshes[piece.mesh].triangles[piece.chosen]


class Geometry:
    """Meshes as vertex and index buffers, and as textures that shaders read by triangle."""

    def __init__(self, gl: moderngl.Context, meshes: tuple[Mesh, ...], trees: tuple[MeshTree, ...]):
        """Without trees triangles lie as in their meshes. Raises ValueError if they are too many."""
        order = Order(meshes, trees)
        if order.count > MOST_TRIANGLES:
            raise ValueError(
                f"the meshes have {order.count:,} triangles, of which this engine can draw {MOST_TRIANGLES:,} "
                "(instances of a mesh count once)"
            )
        self.first_triangle = order.first_triangle
        self.centres = np.array([lattice.centre for lattice in order.lattices]).reshape(-1, 3)
        self.scales = np.array([lattice.scale for lattice in order.lattices])
        halves = [np.subtract(*mesh.box[::-1]) / 2.0 for mesh in meshes]
        self.half_sizes = np.array(halves).reshape(-1, 3) * self.scales[:, None] + 1.0  # steps are rounded
        self.textures = {
            "corners": array_texture(gl, 2 * order.count, 4, "u4"),
            "normals": array_texture(gl, 3 * order.count, 2, "i2"),
        }
        self.vertices = self.indices = None
        self.bytes = 0
        if order.count:
            self._upload(gl, order)

    def _upload(self, gl: moderngl.Context, order: Order) -> None:
        """Make and upload all arrays."""
        source = Source(order)
        vertices = order.count + len(source.others)
        self.vertices, self.indices = gl.buffer(reserve=12 * vertices), gl.buffer(reserve=12 * order.count)
        for first, made in order.made(source.make):
            self.vertices.write(made.vertices, offset=12 * first)
            self.indices.write(made.indices, offset=12 * first)
            write_array(self.textures["corners"], made.corners, 2 * first)
            write_array(self.textures["normals"], made.normals, 3 * first)
        if len(source.others):
            self.vertices.write(source.places(source.others), offset=12 * order.count)
        self.bytes = 12 * vertices + (12 + 32 + 12) * order.count


@dataclass(frozen=True)
class Arrays:
    """What is uploaded of N triangles."""

    vertices: np.ndarray  # (N,3) float32 steps: the last corners
    indices: np.ndarray  # (N,3) uint32
    corners: np.ndarray  # (2 N,4) uint32: see packed_corners
    normals: np.ndarray  # (3 N,2) int16: see snorm


class Source:
    """What the arrays are made from.

    Vertices are copied so that each triangle's last corner bears its number: so no shader needs gl_PrimitiveID, for
    which some drivers copy all corners of all triangles.
    """

    def __init__(self, order: Order):
        self.order = order
        self.steps = np.empty((3, int(order.first_vertex[-1])), np.int32)
        self.octahedra = []
        for mesh, lattice, first in zip(order.meshes, order.lattices, order.first_vertex, strict=False):
            self.steps[:, first : first + len(mesh.positions)] = lattice.steps(mesh.positions)
            self.octahedra.append(snorm(mesh.normals) if mesh.normals.ndim == 2 else None)
        self.copies = np.full(self.steps.shape[1], order.count, np.uint32)
        first = 0
        for piece in order.pieces():
            last = order.triangles(piece)[:, 2] + order.first_vertex[piece.mesh]
            self.copies[last] = np.arange(first, first + len(last), dtype=np.uint32)
            first += len(last)
        #: Vertices that are the last corner of no triangle.
        self.others = np.flatnonzero(self.copies == order.count)
        self.copies[self.others] += np.arange(len(self.others), dtype=np.uint32)

    def places(self, vertices: np.ndarray) -> np.ndarray:
        """(N,3) float32 steps."""
        return np.ascontiguousarray(self.steps.take(vertices, 1).T, np.float32)

    def make(self, first: int, pieces: list[Piece]) -> Arrays:
        """The arrays of the triangles from number `first` on."""
        order = self.order
        triangles = np.concatenate(
            [order.triangles(each) + np.uint32(order.first_vertex[each.mesh]) for each in pieces]
        )
        materials = np.concatenate([order.meshes[each.mesh].materials[each.chosen] for each in pieces])
        indices = self.copies.take(triangles)
        indices[:, 2] = np.arange(first, first + len(triangles))
        corners = packed_corners([along.take(corner) for corner in triangles.T for along in self.steps], materials)
        normals = np.concatenate([self.normals(each) for each in pieces])
        return Arrays(self.places(triangles[:, 2]), indices, corners.reshape(-1, 4), normals)

    def normals(self, piece: Piece) -> np.ndarray:
        """(3 N,2) int16."""
        octahedra = self.octahedra[piece.mesh]
        if octahedra is None:
            return snorm(self.order.meshes[piece.mesh].normals[piece.chosen]).reshape(-1, 2)
        return octahedra.view(np.uint32).take(self.order.triangles(piece)).view(np.int16).reshape(-1, 2)


class Coordinates:
    """Texture coordinates by corner, zero where a mesh has none."""

    def __init__(self, gl: moderngl.Context, meshes: tuple[Mesh, ...], trees: tuple[MeshTree, ...]):
        order = Order(meshes, trees)
        self.texture = array_texture(gl, 3 * order.count, 2, "f4")
        self.bytes = 24 * order.count
        for first, made in order.made(lambda _, pieces: np.concatenate([uvs_of(order, each) for each in pieces])):
            write_array(self.texture, made, 3 * first)


def uvs_of(order: Order, piece: Piece) -> np.ndarray:
    """(3 N,2) float32."""
    uvs = order.meshes[piece.mesh].uvs
    found = uvs[piece.chosen] if len(uvs) else np.zeros((*order.triangles(piece).shape, 2), np.float32)
    return found.reshape(-1, 2)


def packed_corners(corners: list[np.ndarray], materials: np.ndarray) -> np.ndarray:
    """(T,8) uint32: corners, nine coordinates (T,) int32 of 25 bits, and materials (T,) of 28.

    The upper bits of the words are all coordinates but the last; the lower seven are that one, and the material.
    """
    words = np.empty((len(materials), 8), np.uint32)
    for k, along in enumerate(corners[:8]):
        lower = corners[8].view(np.uint32) if k < 4 else materials
        words[:, k] = along.view(np.uint32) << np.uint32(7) | lower >> np.uint32(7 * (k % 4)) & np.uint32(127)
    return words


def snorm(directions: np.ndarray) -> np.ndarray:
    """Unit vectors (…,3) as points (…,2) int16 of the octahedron's square."""
    return np.rint(octahedron_from_directions(directions) * np.float32(32767.0)).astype(np.int16)
