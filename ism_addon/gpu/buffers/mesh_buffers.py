# SPDX-License-Identifier: GPL-3.0-or-later
"""The triangles of all resident meshes on the GPU, in one index space.

Triangles are in the order of BVH leaves, so that the visibility buffer and shadow rays read the same arrays. They are
prepared and uploaded in portions, so that little of them is in main memory at a time.
"""

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

import numpy as np

from ...scene import Mesh, bounding_boxes
from ..accel.blas import BLAS, DeferredBLAS
from ..accel.quantization import Quantization, quantizations
from ..gl.buffer_texture import BufferTexture
from ..gl.context import Device
from ..gl.shader_records import octahedron_from_directions
from .heap_trim import trim_heap
from .small_meshes import JoinedMeshes, small_mesh_groups

#: Triangles that are prepared and uploaded at a time, so that they stay in the processor's cache.
TRIANGLES_AT_A_TIME = 1 << 15

#: Portions that are prepared while one is uploaded.
PORTIONS_AHEAD = 3

#: OpenGL's vertex indices are int32. The size of a driver's buffer textures may be a lower limit.
MAX_TRIANGLES = (2**31 - 1) // 3

Result = TypeVar("Result")


@dataclass(frozen=True)
class QuantizedVertices:
    """Vertices of a source in the format of the upload."""

    quanta: np.ndarray  # (3,V) int32
    octahedra: np.ndarray | None  # (V,2) int16 normals; None where corners have their own


#: For portions whose vertices are not needed.
NO_VERTICES = QuantizedVertices(np.empty((3, 0), np.int32), None)


@dataclass(frozen=True)
class Source:
    """The triangles of a mesh or of joined small meshes, in the order of BVH leaves if they have a BVH."""

    arrays: Mesh | JoinedMeshes
    quanta: Callable[[], np.ndarray]  # computes (3,V) int32
    order: np.ndarray | None  # (T,): the mesh's index of each triangle; None: the mesh's order
    runs: DeferredBLAS | None

    @classmethod
    def of(cls, meshes: Sequence[Mesh], trees: Sequence[BLAS | DeferredBLAS | None]) -> "Source":
        """The source of one mesh, or of several small ones."""
        if len(meshes) == 1:
            (mesh,), (tree,) = meshes, trees
            quanta = partial(Quantization.of(mesh).quantize, mesh.positions)
            return cls(mesh, quanta, tree.order if tree else None, tree if isinstance(tree, DeferredBLAS) else None)
        joined, order = JoinedMeshes(meshes), None
        if trees[0] is not None:
            order = np.concatenate([tree.order for tree in trees if tree]) + joined.first.repeat(joined.counts)
        return cls(joined, partial(joined.quantize, np.int32), order, None)

    def vertices(self) -> QuantizedVertices:
        """Its vertices, quantized."""
        normals = self.arrays.normals
        return QuantizedVertices(self.quanta(), snorm16(normals) if normals.ndim == 2 else None)


@dataclass(frozen=True)
class TriangleRange:
    """A range of a source's triangles."""

    source: Source
    chosen: np.ndarray | slice
    vertices: QuantizedVertices  # of the source

    @property
    def triangles(self) -> np.ndarray:
        """(N,3) uint32, indices of the source's vertices."""
        return self.source.arrays.triangles[self.chosen]

    def positions(self) -> list[np.ndarray]:
        """Nine coordinates (N,) of the corners, in quanta. Also finds boxes of a DeferredBLAS' runs."""
        runs, triangles = self.source.runs, self.triangles
        if runs is None or not isinstance(self.chosen, slice):
            return vertex_positions(triangles, self.vertices)
        first, count = self.chosen.start, len(triangles)
        positions = vertex_positions(self.source.arrays.triangles[first : runs.end_of(first + count)], self.vertices)
        runs.bound(first, positions)
        return [along[:count] for along in positions]


class TriangleOrder:
    """The triangles of several meshes, concatenated."""

    def __init__(self, meshes: Sequence[Mesh], trees: Sequence[BLAS | DeferredBLAS | None]):
        counts = [len(mesh.triangles) for mesh in meshes]
        self.groups = small_mesh_groups(counts)
        self.meshes, self.trees = meshes, trees
        self.runs = [tree for tree in trees if isinstance(tree, DeferredBLAS)]
        self.first_triangle = np.cumsum([0, *counts])

    @property
    def count(self) -> int:
        """Their number."""
        return int(self.first_triangle[-1])

    def portions(self, with_vertices: bool) -> Iterator[list[TriangleRange]]:
        """All triangles in portions of TRIANGLES_AT_A_TIME."""
        latest, source, vertices = -1, None, NO_VERTICES
        ends = self.first_triangle[[0, *(group.stop for group in self.groups)]]
        for ranges in portions(np.diff(ends), TRIANGLES_AT_A_TIME):
            portion = []
            for number, part in ranges:
                if source is None or number != latest:
                    group = self.groups[number]
                    latest, source = number, Source.of(self.meshes[group], self.trees[group])
                    vertices = source.vertices() if with_vertices else NO_VERTICES
                portion.append(TriangleRange(source, part if source.order is None else source.order[part], vertices))
            yield portion

    def map_portions(self, work: Callable[[list[TriangleRange]], Result], with_vertices: bool) -> Iterator[Result]:
        """The results of `work` on each portion, on all cores, in order."""
        waiting: deque[Future[Result]] = deque()
        with ThreadPoolExecutor() as cores:
            for ranges in self.portions(with_vertices):
                waiting.append(cores.submit(work, ranges))
                if len(waiting) > PORTIONS_AHEAD:
                    yield waiting.popleft().result()
            for future in waiting:
                yield future.result()


class MeshBuffers:
    """The resident meshes as buffers indexed by triangle."""

    def __init__(self, device: Device, meshes: tuple[Mesh, ...], in_blas_order: bool):
        """`in_blas_order`: triangles are in the order of BVH leaves, else in the order of their meshes."""
        #: Triangles of each mesh.
        self.counts = np.array([len(mesh.triangles) for mesh in meshes], np.int64)
        self.meshes, self.in_blas_order = meshes, in_blas_order
        #: BVHs of resident meshes by the mesh's index, in the order of upload.
        self.trees: dict[int, BLAS | DeferredBLAS | None] = {}
        #: Of each mesh; -1 if it is not resident.
        self.first_triangle = np.full(len(meshes), -1)
        self.count = self.bytes = 0
        self.centres, self.quanta_per_metre = quantizations(meshes)
        low, high = bounding_boxes(meshes).swapaxes(0, 1)
        self.half_sizes = (high - low) / 2.0 * self.quanta_per_metre[:, None] + 1.0  # quanta are rounded
        self.corners, self.normals = device.growing_buffer(4, "u4"), device.growing_buffer(2, "i2")
        self.most = min(MAX_TRIANGLES, device.buffer_textures.max_rows // 3)  # normals have three rows each

    @property
    def samplers(self) -> dict[str, BufferTexture]:
        """By the name of the sampler. Two rows of corners a triangle, and three of normals."""
        return {"corners": self.corners.texture, "corner_normal_buffer": self.normals.texture}

    def add(self, wanted: Iterable[int], trees: Mapping[int, BLAS | DeferredBLAS]) -> int:
        """Upload those of the wanted meshes that are not resident: the number of bytes.

        Raises ValueError for more triangles than OpenGL can draw.
        """
        new = [number for number in wanted if number not in self.trees]
        own = {number: trees[number] if self.in_blas_order else None for number in new}
        order = TriangleOrder([self.meshes[number] for number in new], list(own.values()))
        if (count := self.count + order.count) > self.most:
            raise ValueError(
                f"the meshes have {count:,} triangles, of which this OpenGL can draw {self.most:,} "
                "(instances of a mesh count once)"
            )
        trim_heap()  # after reading and building BVHs: most memory is in use from here on
        self.corners.count, self.normals.count = 2 * self.count, 3 * self.count  # without a failed upload
        self.corners.reserve(2 * order.count)
        self.normals.reserve(3 * order.count)
        for corners, normals in order.map_portions(buffers_of, with_vertices=True):
            self.corners.append(corners)
            self.normals.append(normals)
        for runs in order.runs:
            runs.build_async()
        # Last: after a failure the meshes are not resident, and the next image uploads them again.
        self.first_triangle[new] = self.count + order.first_triangle[:-1]
        self.trees |= own
        self.count += order.count
        self.bytes += (32 + 12) * order.count
        return (32 + 12) * order.count

    def order(self, numbers: Sequence[int]) -> TriangleOrder:
        """The triangles of several resident meshes."""
        return TriangleOrder([self.meshes[number] for number in numbers], [self.trees[number] for number in numbers])


def buffers_of(ranges: list[TriangleRange]) -> tuple[np.ndarray, np.ndarray]:
    """Corners (2 N,4) uint32 and normals (3 N,2) int16 of N triangles."""
    corners, normals = zip(*map(buffers_of_range, ranges), strict=True)
    return np.concatenate(corners), np.concatenate(normals)


def buffers_of_range(range_: TriangleRange) -> tuple[np.ndarray, np.ndarray]:
    """Likewise, of one range."""
    arrays, vertices = range_.source.arrays, range_.vertices
    corners = packed_corners(range_.positions(), arrays.materials[range_.chosen]).reshape(-1, 4)
    if vertices.octahedra is None:
        return corners, snorm16(arrays.normals[range_.chosen]).reshape(-1, 2)
    return corners, vertices.octahedra.view(np.uint32).take(range_.triangles).view(np.int16).reshape(-1, 2)


def vertex_positions(triangles: np.ndarray, vertices: QuantizedVertices) -> list[np.ndarray]:
    """Nine coordinates (N,) int32 of the corners of triangles (N,3): x, y and z of the first corner, and so on."""
    return [along.take(corner) for corner in np.ascontiguousarray(triangles.T) for along in vertices.quanta]


class UVBuffers:
    """Texture coordinates by corner, zero where a mesh has none."""

    def __init__(self, device: Device, mesh_buffers: MeshBuffers):
        self.mesh_buffers, self.meshes, self.bytes = mesh_buffers, 0, 0
        self.uvs = device.growing_buffer(2, "f4")

    def upload_new(self) -> int:
        """Upload those of meshes that became resident: the number of bytes."""
        order = self.mesh_buffers.order(list(self.mesh_buffers.trees)[self.meshes :])
        self.uvs.count = self.bytes // self.uvs.texture.row  # without a failed upload
        self.uvs.reserve(3 * order.count)
        for uvs in order.map_portions(uvs_of, with_vertices=False):
            self.uvs.append(uvs)
        self.meshes += len(order.meshes)
        self.bytes += 24 * order.count
        return 24 * order.count


def uvs_of(ranges: list[TriangleRange]) -> np.ndarray:
    """(3 N,2) float32 of N triangles."""
    nothing = np.zeros((TRIANGLES_AT_A_TIME, 3, 2), np.float32)
    every = ((range_.source.arrays.uvs, range_) for range_ in ranges)
    found = [uvs[range_.chosen] if len(uvs) else nothing[: len(range_.triangles)] for uvs, range_ in every]
    return np.concatenate(found).reshape(-1, 2)


def portions(lengths: Iterable[int], size: int) -> Iterator[list[tuple[int, slice]]]:
    """Split concatenated arrays of these lengths into portions of `size`: of each, ranges as array index and slice."""
    ranges, left = [], size
    for index, length in enumerate(lengths):
        first = 0
        while first < length:
            end = min(first + left, length)
            ranges.append((index, slice(first, end)))
            left -= end - first
            first = end
            if not left:
                yield ranges
                ranges, left = [], size
    if ranges:
        yield ranges


def packed_corners(corners: list[np.ndarray], materials: np.ndarray) -> np.ndarray:
    """(T,8) uint32: nine coordinates (T,) int32 of corners, 25 bits each, and material indices (T,), 28 bits.

    The upper 25 bits of each word are one of eight coordinates. The lower seven bits of four words each are the ninth,
    and the material index.
    """
    words = np.empty((len(materials), 8), np.uint32)
    for k, along in enumerate(corners[:8]):
        lower = corners[8].view(np.uint32) if k < 4 else materials
        words[:, k] = along.view(np.uint32) << np.uint32(7) | lower >> np.uint32(7 * (k % 4)) & np.uint32(127)
    return words


def snorm16(directions: np.ndarray) -> np.ndarray:
    """Octahedral encoding (…,2) int16 of unit vectors (…,3)."""
    return np.rint(octahedron_from_directions(directions) * np.float32(32767.0)).astype(np.int16)
