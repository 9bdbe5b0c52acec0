# SPDX-License-Identifier: GPL-3.0-or-later
"""The bottom-level BVH of one mesh, and the order of its triangles on the GPU: those of a leaf are consecutive.

In most meshes, consecutive triangles are close together. Then a leaf is a run of triangles in the mesh's order, and the
BVH is built over runs. The runs' boxes are computed during the upload of the triangles, which reads the corners anyway.
The BVH is built while the visibility buffer is drawn.
"""

from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import reduce

import numpy as np

from ...parallel import parallel_map
from ...scene import Mesh
from .bvh import MIN_MAX, QUANTA_PER_PLANE, assign_leaves, build, leaves_for, packed, packed_nodes_over, quantize_boxes
from .quantization import Quantization

#: Maximum of triangles in a leaf: with fewer, BVHs are larger; with more, rays test more triangles. The number of
#: leaves is a power of four, so a leaf has at least 1.5 triangles on average. An even number, as a quad is two
#: triangles. This and the constants below: see `dev.py bench constants` in docs/benchmarks.md.
TRIANGLES_PER_LEAF = 6

#: Up to this many triangles, the BVH is over triangles, not runs: tracing is a tenth faster in the atrium's statue.
SORT_ALL_BELOW = 1 << 17

#: Number of triangles that are sampled to decide whether runs are compact.
SAMPLED_TRIANGLES = 1 << 14

#: A run is compact if its box has at most MAX_OVERLAP times the surface area of its triangles' boxes. Runs are used if
#: at least COHERENT_FRACTION of them are compact: where rows of a grid end, some are not. More loose runs make tracing
#: slower; fewer meshes in runs make building slower.
MAX_OVERLAP, COHERENT_FRACTION = 3.0, 0.9

#: Maximum number of boxes of a mesh from which the bounds of its instances are computed; a power of two.
BOXES_PER_MESH = 32

#: Triangles whose boxes are computed at a time, so that they stay in the processor's cache.
TRIANGLES_AT_A_TIME = 1 << 15


@dataclass(frozen=True, eq=False)
class BLAS:
    """A mesh's BVH, in quanta of its quantization, and the triangles of its leaves."""

    #: (P,2,3) quanta, P = min(BOXES_PER_MESH, leaves): boxes that contain the mesh, tighter than one when rotated.
    bounds: np.ndarray
    nodes: np.ndarray  # (leaves // 2,) BVH_NODE
    leaf_starts: np.ndarray  # (leaves,) uint32: the first triangle of each leaf
    triangles_per_leaf: int  # that rays test, from the leaf's start on
    order: np.ndarray | None  # (T,) uint32: the mesh's index of each triangle on the GPU; None: the mesh's order

    @property
    def leaves(self) -> int:
        """Number of leaves."""
        return len(self.leaf_starts)

    @property
    def blas(self) -> "BLAS":
        """Itself; the same interface as DeferredBLAS.blas."""
        return self


class DeferredBLAS:
    """A BVH over runs of a large mesh, which is built when the boxes of all runs are known."""

    order = None

    def __init__(self, quantization: Quantization, count: int):
        self.quantization, self.count, self.run = quantization, count, run_length(count)
        self.boxes = np.empty((2, 3, -(-count // self.run)), np.int16)  # in planes
        self.future: Future[BLAS] | None = None

    def end_of(self, triangle: int) -> int:
        """End of the run that contains the triangle before this one."""
        return min(-(-triangle // self.run) * self.run, self.count)

    def bound(self, first: int, corners: list[np.ndarray]) -> None:
        """Compute the boxes of the runs that begin at triangle `first` or later.

        `corners`: nine coordinates (N,) in quanta, of N triangles; they end with a run.
        """
        if self.future is not None:
            return
        runs = slice(-(-first // self.run), -(-(first + len(corners[0])) // self.run))
        boxes = np.empty((2, 3, runs.stop - runs.start), np.float32)
        for side, min_or_max in enumerate(MIN_MAX):
            for axis in range(3):
                bounds = reduce(min_or_max, corners[axis::3])[runs.start * self.run - first :]
                bounds = np.pad(bounds, (0, -len(bounds) % self.run), mode="edge").reshape(-1, self.run)
                boxes[side, axis] = reduce(min_or_max, bounds.T)
        self.boxes[:, :, runs] = quantize_boxes(boxes)

    def build_async(self) -> "Future[BLAS]":
        """Start to build the BVH in a new thread, unless it was started."""
        if self.future is None:
            thread = ThreadPoolExecutor(1)
            self.future = thread.submit(blas_of_runs, self.boxes, self.count)
            thread.shutdown(wait=False)
        return self.future

    @property
    def blas(self) -> BLAS:
        """The BVH; waits until it is built. Raises what building raises, such as MemoryError; the next call retries."""
        try:
            built = self.build_async().result()
        except BaseException:
            self.future = None
            raise
        self.boxes = self.boxes[:, :, :0].copy()
        return built


def build_blas(mesh: Mesh) -> BLAS | DeferredBLAS:
    """The BVH of a mesh that is not empty: built, or deferred until its triangles are uploaded."""
    quantization = Quantization.of(mesh)
    if len(mesh.triangles) > SORT_ALL_BELOW and is_coherent(mesh, quantization):
        return DeferredBLAS(quantization, len(mesh.triangles))
    return blas_of_triangles(quantization.quantize(mesh.positions, np.float32), mesh.triangles)


def is_coherent(mesh: Mesh, quantization: Quantization) -> bool:
    """Whether the fraction of compact runs is large enough, estimated from a sample of the runs."""
    run, count = run_length(len(mesh.triangles)), len(mesh.triangles)
    sampled = mesh.triangles[: count // run * run].reshape(-1, run, 3)[:: -(-count // SAMPLED_TRIANGLES)]
    corners = quantization.quantize(mesh.positions[sampled.ravel()], np.float32).reshape(3, -1, 3)
    triangle_areas = half_areas(corners.min(2), corners.max(2)).reshape(-1, run).sum(1)
    runs = corners.reshape(3, -1, 3 * run)
    is_compact = half_areas(runs.min(2), runs.max(2)) <= MAX_OVERLAP * triangle_areas
    return bool(np.mean(is_compact) >= COHERENT_FRACTION)


def blas_of_triangles(quanta: np.ndarray, triangles: np.ndarray) -> BLAS:
    """The BVH over single triangles; quanta are (3,V)."""
    bvh = build(triangle_boxes(quanta, triangles), TRIANGLES_PER_LEAF)
    is_used = bvh.order < len(triangles)
    counts = np.count_nonzero(is_used.reshape(bvh.leaves, -1), 1)
    # Rays test the same number of triangles in each leaf; if it is not full, some are of a neighbouring leaf.
    starts = np.minimum(np.cumsum(counts) - counts, len(triangles) - bvh.boxes_per_leaf)
    order = bvh.order[is_used].astype(np.uint32)
    return BLAS(mesh_bounds(bvh.nodes), packed(bvh.nodes), starts.astype(np.uint32), bvh.boxes_per_leaf, order)


def blas_of_runs(boxes: np.ndarray, count: int) -> BLAS:
    """The BVH over boxes (2,3,R) of runs of a mesh of `count` triangles."""
    run, members = run_length(count), assign_leaves(boxes, leaves_for(count, TRIANGLES_PER_LEAF))
    rows, nodes = packed_nodes_over(boxes, members)
    starts = np.minimum(members * run, count - run).astype(np.uint32)
    return BLAS(mesh_bounds(nodes), rows, starts, run, None)


def run_length(count: int) -> int:
    """Triangles in each run of a mesh of `count` triangles: an even number, which does not split quads."""
    return 2 * -(-count // (2 * leaves_for(count, TRIANGLES_PER_LEAF)))


def triangle_boxes(quanta: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(2,3,T) int16 planes: bounding boxes of triangles (T,3) with vertices (3,V) in quanta."""
    boxes = np.empty((2, 3, len(triangles)), np.int16)

    def fill(first: int) -> None:
        chunk = slice(first, first + TRIANGLES_AT_A_TIME)
        corners = quanta.take(np.ascontiguousarray(triangles[chunk].T), 1)
        boxes[:, :, chunk] = quantize_boxes(np.stack([corners.min(1), corners.max(1)]))

    parallel_map(fill, range(0, len(triangles), TRIANGLES_AT_A_TIME), len(triangles))
    return boxes


def half_areas(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """(N,): half the surface areas of boxes with corners `low` (3,N) and `high` (3,N)."""
    x, y, z = high - low
    return x * y + y * z + z * x


def mesh_bounds(nodes: np.ndarray) -> np.ndarray:
    """BLAS.bounds of BVH.nodes."""
    level = min(BOXES_PER_MESH, nodes.shape[2] // 2)
    boxes = nodes[:, :, level : 2 * level].transpose(2, 0, 1)
    boxes = boxes[boxes[:, 0, 0] <= boxes[:, 1, 0]] * np.float32(QUANTA_PER_PLANE)
    return boxes[np.arange(level) % len(boxes)]
