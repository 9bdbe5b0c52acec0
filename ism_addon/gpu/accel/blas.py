# SPDX-License-Identifier: GPL-3.0-or-later
"""The bottom-level BVH of one mesh, and the order of its triangles on the GPU: those of a leaf are consecutive.

Consecutive triangles of a mesh are mostly close together. Where they are, a leaf is a run of them in the mesh's order,
and the BVH is built over runs. Their boxes are found during the upload of the triangles, which reads the corners
anyway; the BVH is built while the visibility buffer is drawn.
"""

from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import reduce

import numpy as np

from ...parallel import parallel_map
from ...scene import Mesh
from .bvh import MIN_MAX, QUANTA_PER_PLANE, assign_leaves, build, leaves_for, packed, packed_nodes_over, quantize_boxes
from .quantization import Quantization

#: Most triangles in a leaf: with fewer, trees are larger; with more, rays test more triangles. The number of leaves is
#: a power of four, so a leaf has 1.5 triangles on average at least. An even number, as a quad is two triangles. This
#: and the constants below: see `dev.py bench constants` in docs/benchmarks.md.
TRIANGLES_PER_LEAF = 6

#: Up to so many triangles the BVH is built over triangles, not runs: tracing is a tenth faster in the atrium's statue.
SORT_ALL_BELOW = 1 << 17

#: Triangles that are tested to see whether runs are compact.
SAMPLED_TRIANGLES = 1 << 14

#: A run is compact if its box has at most this many times the surface of its triangles' boxes. Runs are used if this
#: fraction of them is compact: where rows of a grid end, some are not. More triangles in loose runs make tracing
#: slower, fewer meshes in runs make building slower.
MAX_OVERLAP, COHERENT_FRACTION = 3.0, 0.9

#: Most boxes of a mesh from which the bounds of its instances are computed; a power of two.
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
    triangles_per_leaf: int  # that rays test, from there on
    order: np.ndarray | None  # (T,) uint32: the mesh's index of each triangle on the GPU; None: the mesh's order

    @property
    def leaves(self) -> int:
        """Their number."""
        return len(self.leaf_starts)

    @property
    def blas(self) -> "BLAS":
        """Itself, as DeferredBLAS.blas."""
        return self


class DeferredBLAS:
    """A BVH over runs of a large mesh, which is built once the boxes of all runs are known."""

    order = None

    def __init__(self, quantization: Quantization, count: int):
        self.quantization, self.count, self.run = quantization, count, run_of(count)
        self.boxes = np.empty((2, 3, -(-count // self.run)), np.int16)  # in planes
        self.future: Future[BLAS] | None = None

    def end_of(self, triangle: int) -> int:
        """The end of the run to which the triangle before this one belongs."""
        return min(-(-triangle // self.run) * self.run, self.count)

    def bound(self, first: int, corners: list[np.ndarray]) -> None:
        """Find the boxes of runs from triangle `first` on, the last complete, by nine coordinates (N,) in quanta."""
        if self.future is not None:
            return
        runs = slice(-(-first // self.run), -(-(first + len(corners[0])) // self.run))
        found = np.empty((2, 3, runs.stop - runs.start), np.float32)
        for side, either in enumerate(MIN_MAX):
            for axis in range(3):
                along = reduce(either, corners[axis::3])[runs.start * self.run - first :]
                along = np.pad(along, (0, -len(along) % self.run), mode="edge").reshape(-1, self.run)
                found[side, axis] = reduce(either, along.T)
        self.boxes[:, :, runs] = quantize_boxes(found)

    def build_async(self) -> "Future[BLAS]":
        """Start to build the BVH on a thread of its own."""
        if self.future is None:
            thread = ThreadPoolExecutor(1)
            self.future = thread.submit(blas_of_runs, self.boxes, self.count)
            thread.shutdown(wait=False)
        return self.future

    @property
    def blas(self) -> BLAS:
        """Wait for the BVH. Raises what building raises, such as MemoryError; the next call builds again."""
        try:
            built = self.build_async().result()
        except BaseException:
            self.future = None
            raise
        self.boxes = self.boxes[:, :, :0].copy()
        return built


def build_blas(mesh: Mesh) -> BLAS | DeferredBLAS:
    """The BVH of a mesh, which has triangles: finished, or deferred until its triangles are uploaded."""
    quantization = Quantization.of(mesh)
    if len(mesh.triangles) > SORT_ALL_BELOW and is_coherent(mesh, quantization):
        return DeferredBLAS(quantization, len(mesh.triangles))
    return blas_of_triangles(quantization.quantize(mesh.positions, np.float32), mesh.triangles)


def is_coherent(mesh: Mesh, quantization: Quantization) -> bool:
    """Whether most of a mesh's runs are compact, by a sample of them."""
    run, count = run_of(len(mesh.triangles)), len(mesh.triangles)
    sampled = mesh.triangles[: count // run * run].reshape(-1, run, 3)[:: -(-count // SAMPLED_TRIANGLES)]
    corners = quantization.quantize(mesh.positions[sampled.ravel()], np.float32).reshape(3, -1, 3)
    inside = surfaces(corners.min(2), corners.max(2)).reshape(-1, run).sum(1)
    of_runs = corners.reshape(3, -1, 3 * run)
    return bool(np.mean(surfaces(of_runs.min(2), of_runs.max(2)) <= MAX_OVERLAP * inside) >= COHERENT_FRACTION)


def blas_of_triangles(quanta: np.ndarray, triangles: np.ndarray) -> BLAS:
    """The BVH over single triangles; quanta are (3,V)."""
    tree = build(boxes_of(quanta, triangles), TRIANGLES_PER_LEAF)
    real = tree.order < len(triangles)
    filled = np.count_nonzero(real.reshape(tree.leaves, -1), 1)
    # Rays test as many triangles in a leaf that is not full: some of the next leaf's, or of the last one's neighbour.
    starts = np.minimum(np.cumsum(filled) - filled, len(triangles) - tree.boxes_per_leaf)
    order = tree.order[real].astype(np.uint32)
    return BLAS(bounds_of(tree.nodes), packed(tree.nodes), starts.astype(np.uint32), tree.boxes_per_leaf, order)


def blas_of_runs(boxes: np.ndarray, count: int) -> BLAS:
    """The BVH over boxes (2,3,R) of runs of a mesh of `count` triangles."""
    run, members = run_of(count), assign_leaves(boxes, leaves_for(count, TRIANGLES_PER_LEAF))
    rows, nodes = packed_nodes_over(boxes, members)
    starts = np.minimum(members * run, count - run).astype(np.uint32)
    return BLAS(bounds_of(nodes), rows, starts, run, None)


def run_of(count: int) -> int:
    """Triangles in a run of a mesh of `count` triangles: an even number, which does not split quads."""
    return 2 * -(-count // (2 * leaves_for(count, TRIANGLES_PER_LEAF)))


def boxes_of(quanta: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(2,3,T) int16: boxes around triangles (T,3) of quanta (3,V), in planes."""
    boxes = np.empty((2, 3, len(triangles)), np.int16)

    def find(first: int) -> None:
        part = slice(first, first + TRIANGLES_AT_A_TIME)
        corners = quanta.take(np.ascontiguousarray(triangles[part].T), 1)
        boxes[:, :, part] = quantize_boxes(np.stack([corners.min(1), corners.max(1)]))

    parallel_map(find, range(0, len(triangles), TRIANGLES_AT_A_TIME), len(triangles))
    return boxes


def surfaces(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """(N,) half the surface area of boxes from (3,N) to (3,N)."""
    x, y, z = high - low
    return x * y + y * z + z * x


def bounds_of(nodes: np.ndarray) -> np.ndarray:
    """BLAS.bounds of BVH.nodes."""
    level = min(BOXES_PER_MESH, nodes.shape[2] // 2)
    boxes = nodes[:, :, level : 2 * level].transpose(2, 0, 1)
    boxes = boxes[boxes[:, 0, 0] <= boxes[:, 1, 0]] * np.float32(QUANTA_PER_PLANE)
    return boxes[np.arange(level) % len(boxes)]
