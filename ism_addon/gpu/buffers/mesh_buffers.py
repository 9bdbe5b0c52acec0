# SPDX-License-Identifier: GPL-3.0-or-later
"""The triangles of all resident meshes on the GPU, in one index space.

Triangles are in the order of BVH leaves, so that the visibility buffer and shadow rays read the same arrays. They are
prepared and uploaded in portions, to limit the use of main memory.
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
from ..gl.shader_records import packed_octahedron
from .heap_trim import trim_heap
from .small_meshes import JoinedMeshes, small_mesh_groups

#: Triangles that are prepared and uploaded at a time, so that they stay in the processor's cache.
TRIANGLES_AT_A_TIME = 1 << 15

#: Number of portions that are prepared in advance while one is uploaded.
PORTIONS_AHEAD = 3

#: Limit of OpenGL's vertex indices, which are int32. A driver's limit of buffer textures may be lower.
MAX_TRIANGLES = (2**31 - 1) // 3

Result = TypeVar("Result")


@dataclass(frozen=True)
class QuantizedVertices:
    """Vertices of a TriangleSource in the format of the GPU's buffers."""

    quanta: np.ndarray  # (3,V) int32
    octahedra: np.ndarray | None  # (V,2) int16 normals; None if there is a normal for each corner


#: For work on triangles that does not read vertices.
NO_VERTICES = QuantizedVertices(np.empty((3, 0), np.int32), None)


@dataclass(frozen=True)
class TriangleSource:
    """The triangles of a mesh or of joined small meshes, in the order of BVH leaves if they have a BVH."""

    arrays: Mesh | JoinedMeshes
    quantize: Callable[[], np.ndarray]  # computes quanta (3,V) int32
    order: np.ndarray | None  # (T,): the mesh's index of each triangle; None: the mesh's order
    deferred_blas: DeferredBLAS | None  # needs the boxes of runs

    @classmethod
    def of(cls, meshes: Sequence[Mesh], blases: Sequence[BLAS | DeferredBLAS | None]) -> "TriangleSource":
        """The source of one mesh, or of several small ones."""
        if len(meshes) == 1:
            (mesh,), (blas,) = meshes, blases
            quantize = partial(Quantization.of(mesh).quantize, mesh.positions)
            return cls(mesh, quantize, blas.order if blas else None, blas if isinstance(blas, DeferredBLAS) else None)
        joined, order = JoinedMeshes(meshes), None
        if blases[0] is not None:
            order = np.concatenate([blas.order for blas in blases if blas]) + joined.first.repeat(joined.counts)
        return cls(joined, partial(joined.quantize, np.int32), order, None)

    def vertices(self) -> QuantizedVertices:
        """The vertices, quantized."""
        normals = self.arrays.normals
        return QuantizedVertices(self.quantize(), packed_octahedron(normals) if normals.ndim == 2 else None)


@dataclass(frozen=True)
class TriangleRange:
    """A range of a source's triangles."""

    source: TriangleSource
    indices: np.ndarray | slice  # in the source's arrays
    vertices: QuantizedVertices  # of the source

    @property
    def triangles(self) -> np.ndarray:
        """(N,3) uint32: indices of the source's vertices."""
        return self.source.arrays.triangles[self.indices]

    def positions(self) -> list[np.ndarray]:
        """Nine coordinates (N,) of the corners, in quanta. Also computes the boxes of a DeferredBLAS's runs."""
        deferred_blas, triangles = self.source.deferred_blas, self.triangles
        if deferred_blas is None or not isinstance(self.indices, slice):
            return vertex_positions(triangles, self.vertices)
        first, count = self.indices.start, len(triangles)
        end = deferred_blas.end_of(first + count)
        positions = vertex_positions(self.source.arrays.triangles[first:end], self.vertices)
        deferred_blas.bound(first, positions)
        return [coordinates[:count] for coordinates in positions]


class TriangleOrder:
    """The order of the triangles of several meshes, concatenated."""

    def __init__(self, meshes: Sequence[Mesh], blases: Sequence[BLAS | DeferredBLAS | None]):
        counts = [len(mesh.triangles) for mesh in meshes]
        self.groups = small_mesh_groups(counts)
        self.meshes, self.blases = meshes, blases
        self.deferred = [blas for blas in blases if isinstance(blas, DeferredBLAS)]
        self.first_triangle = np.cumsum([0, *counts])

    @property
    def count(self) -> int:
        """Number of triangles."""
        return int(self.first_triangle[-1])

    def portions(self, with_vertices: bool) -> Iterator[list[TriangleRange]]:
        """All triangles in portions of TRIANGLES_AT_A_TIME."""
        source_index, source, vertices = -1, None, NO_VERTICES
        ends = self.first_triangle[[0, *(group.stop for group in self.groups)]]
        for ranges in portions(np.diff(ends), TRIANGLES_AT_A_TIME):
            portion = []
            for index, range_ in ranges:
                if source is None or index != source_index:
                    group = self.groups[index]
                    source_index, source = index, TriangleSource.of(self.meshes[group], self.blases[group])
                    vertices = source.vertices() if with_vertices else NO_VERTICES
                indices = range_ if source.order is None else source.order[range_]
                portion.append(TriangleRange(source, indices, vertices))
            yield portion

    def map_portions(self, work: Callable[[list[TriangleRange]], Result], with_vertices: bool) -> Iterator[Result]:
        """The results of `work` on each portion, on all cores, in order."""
        pending: deque[Future[Result]] = deque()
        with ThreadPoolExecutor() as cores:
            for ranges in self.portions(with_vertices):
                pending.append(cores.submit(work, ranges))
                if len(pending) > PORTIONS_AHEAD:
                    yield pending.popleft().result()
            for future in pending:
                yield future.result()


class MeshBuffers:
    """Buffers of the resident meshes, indexed by triangle."""

    def __init__(self, device: Device, meshes: tuple[Mesh, ...], in_blas_order: bool):
        """`in_blas_order`: triangles are in the order of BVH leaves, else in the order of their meshes."""
        #: Number of triangles of each mesh.
        self.counts = np.array([len(mesh.triangles) for mesh in meshes], np.int64)
        self.meshes, self.in_blas_order = meshes, in_blas_order
        #: BVHs of resident meshes by the mesh's index, in the order of upload.
        self.blases: dict[int, BLAS | DeferredBLAS | None] = {}
        #: The first triangle of each mesh in the buffers; -1 if the mesh is not resident.
        self.first_triangle = np.full(len(meshes), -1)
        self.count = self.bytes = 0
        self.centres, self.quanta_per_metre = quantizations(meshes)
        low, high = bounding_boxes(meshes).swapaxes(0, 1)
        self.half_sizes = (high - low) / 2.0 * self.quanta_per_metre[:, None] + 1.0  # quanta are rounded
        self.corners, self.normals = device.growing_buffer(4, "u4"), device.growing_buffer(2, "i2")
        self.max_triangles = min(
            MAX_TRIANGLES, device.buffer_textures.max_rows // 3
        )  # a triangle has 3 rows of normals

    @property
    def samplers(self) -> dict[str, BufferTexture]:
        """The buffers by sampler name. A triangle has two rows of corners, and three of normals."""
        return {"corners": self.corners.texture, "corner_normal_buffer": self.normals.texture}

    def add(self, needed: Iterable[int], blases: Mapping[int, BLAS | DeferredBLAS]) -> int:
        """Upload those of the needed meshes that are not resident. Returns the number of bytes.

        Raises ValueError for more triangles than OpenGL can draw.
        """
        new = [index for index in needed if index not in self.blases]
        new_blases = {index: blases[index] if self.in_blas_order else None for index in new}
        order = TriangleOrder([self.meshes[index] for index in new], list(new_blases.values()))
        if (count := self.count + order.count) > self.max_triangles:
            raise ValueError(
                f"the meshes have {count:,} triangles, of which this OpenGL can draw {self.max_triangles:,} "
                "(instances of a mesh count once)"
            )
        trim_heap()  # after reading and building BVHs; the use of memory is highest from here on
        # Overwrite the rows of an upload that failed.
        self.corners.count, self.normals.count = 2 * self.count, 3 * self.count
        self.corners.reserve(2 * order.count)
        self.normals.reserve(3 * order.count)
        for corners, normals in order.map_portions(buffers_of, with_vertices=True):
            self.corners.append(corners)
            self.normals.append(normals)
        for blas in order.deferred:
            blas.build_async()
        # At the end, so that after a failure the meshes are not resident, and the next image uploads them again.
        self.first_triangle[new] = self.count + order.first_triangle[:-1]
        self.blases |= new_blases
        self.count += order.count
        self.bytes += (32 + 12) * order.count
        return (32 + 12) * order.count

    def order(self, indices: Sequence[int]) -> TriangleOrder:
        """The triangles of resident meshes with these indices."""
        return TriangleOrder([self.meshes[index] for index in indices], [self.blases[index] for index in indices])

    def rows_of(self, mesh: np.ndarray, triangles: np.ndarray) -> np.ndarray:
        """(P,) rows of triangles (P,) of meshes with these indices (P,); -1: the mesh is not resident."""
        result = np.full(len(mesh), -1)
        for k in np.unique(mesh).tolist():
            if self.first_triangle[k] < 0:
                continue
            chosen, blas = mesh == k, self.blases[k]
            own = triangles[chosen]
            if blas is not None and blas.order is not None:
                own = np.argsort(blas.order)[own]
            result[chosen] = self.first_triangle[k] + own
        return result


def buffers_of(ranges: list[TriangleRange]) -> tuple[np.ndarray, np.ndarray]:
    """Corners (2 N,4) uint32 and normals (3 N,2) int16 of N triangles."""
    corners, normals = zip(*map(buffers_of_range, ranges), strict=True)
    return np.concatenate(corners), np.concatenate(normals)


def buffers_of_range(range_: TriangleRange) -> tuple[np.ndarray, np.ndarray]:
    """The same for one range."""
    arrays, vertices = range_.source.arrays, range_.vertices
    corners = packed_corners(range_.positions(), arrays.materials[range_.indices]).reshape(-1, 4)
    if vertices.octahedra is None:
        return corners, packed_octahedron(arrays.normals[range_.indices]).reshape(-1, 2)
    return corners, vertices.octahedra.view(np.uint32).take(range_.triangles).view(np.int16).reshape(-1, 2)


def vertex_positions(triangles: np.ndarray, vertices: QuantizedVertices) -> list[np.ndarray]:
    """Nine coordinates (N,) int32 of the corners of triangles (N,3): x, y and z of the first corner, and so on."""
    return [axis.take(corner) for corner in np.ascontiguousarray(triangles.T) for axis in vertices.quanta]


def portions(lengths: Iterable[int], size: int) -> Iterator[list[tuple[int, slice]]]:
    """Split concatenated arrays of these lengths into portions of `size`: lists of array indices and slices."""
    ranges, remaining = [], size
    for index, length in enumerate(lengths):
        first = 0
        while first < length:
            end = min(first + remaining, length)
            ranges.append((index, slice(first, end)))
            remaining -= end - first
            first = end
            if not remaining:
                yield ranges
                ranges, remaining = [], size
    if ranges:
        yield ranges


def packed_corners(corners: list[np.ndarray], materials: np.ndarray) -> np.ndarray:
    """(T,8) uint32: nine coordinates (T,) int32 of corners, 25 bits each, and material indices (T,), 28 bits.

    The upper 25 bits of the eight words are the first eight coordinates. The lower seven bits of the first four words
    are the ninth coordinate, those of the last four are the material index.
    """
    words = np.empty((len(materials), 8), np.uint32)
    for k, coordinates in enumerate(corners[:8]):
        lower = corners[8].view(np.uint32) if k < 4 else materials
        lower_bits = lower >> np.uint32(7 * (k % 4)) & np.uint32(127)
        words[:, k] = coordinates.view(np.uint32) << np.uint32(7) | lower_bits
    return words
