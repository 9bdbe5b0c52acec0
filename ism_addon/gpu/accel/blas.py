# SPDX-License-Identifier: GPL-3.0-or-later
"""The tree of one mesh, and the order in which its triangles lie on the GPU, so that those of a leaf are neighbours.

Triangles that follow one another in a mesh mostly lie together too. Where they do, a leaf is a run of them as they are,
and what is sorted is runs. They are bounded while their triangles are made ready for the upload, when their corners are
at hand, and sorted while the camera's pass draws them.
"""

from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import reduce

import numpy as np

from ...parallel import parallel_map
from ...scene import Mesh
from .bvh import MIN_MAX, QUANTA_PER_PLANE, assign_leaves, build, leaves_for, packed, packed_nodes_over, quantize_boxes
from .quantization import Quantization

#: Most triangles in a leaf: fewer make larger trees, more are tested in vain. Leaves are a power of four, so they
#: hold 1.5 on average at least. An even number, as quads are two.
TRIANGLES_PER_LEAF = 6

#: Meshes of so few triangles are sorted one by one: rays are quicker, by a tenth in the atrium's statue.
SORT_ALL_BELOW = 1 << 17

#: Triangles that are looked at to see whether neighbours in a mesh lie together.
SAMPLED_TRIANGLES = 1 << 14

#: Neighbours in a mesh lie together where the box around them has this many times the surface of their own boxes at
#: most, and mostly is: grids' rows have ends. More, and rays take long; less, and sorting does.
MAX_OVERLAP, COHERENT_FRACTION = 3.0, 0.9

#: Most boxes of a mesh by which its instances are bounded; a power of two.
BOXES_PER_MESH = 32

#: Triangles whose boxes are found at a time: so many stay in a processor's cache.
TRIANGLES_AT_A_TIME = 1 << 15


@dataclass(frozen=True, eq=False)
class BLAS:
    """A mesh's tree in its quantization's quanta, and where its leaves' triangles are."""

    bounds: (
        np.ndarray
    )  # (P,2,3) quanta, P = min(BOXES_PER_MESH, leaves): boxes around all of the mesh, closer than one when turned
    nodes: np.ndarray  # (leaves // 2,) NODE
    starts: np.ndarray  # (leaves,) uint32: the first triangle of each leaf
    per_leaf: int  # triangles from there on that a leaf looks at
    order: np.ndarray | None  # (T,) uint32: which triangle of the mesh is where; None: all are where they were

    @property
    def leaves(self) -> int:
        """How many there are."""
        return len(self.starts)

    @property
    def blas(self) -> "BLAS":
        """This one: see Runs."""
        return self


class DeferredBLAS:
    """A large mesh whose triangles stay where they are; its tree is begun when all runs of them have been bounded."""

    order = None

    def __init__(self, quantization: Quantization, count: int):
        self.quantization, self.count, self.run = quantization, count, run_of(count)
        self.boxes = np.empty((2, 3, -(-count // self.run)), np.int16)  # in planes
        self.future: Future[BLAS] | None = None

    def end_of(self, triangle: int) -> int:
        """Where the run ends that has the triangle before this one."""
        return min(-(-triangle // self.run) * self.run, self.count)

    def bound(self, first: int, corners: list[np.ndarray]) -> None:
        """Runs that begin in triangles from `first` to the end of one, by nine coordinates (N,) in quanta."""
        if self.future is not None:
            return
        begun = slice(-(-first // self.run), -(-(first + len(corners[0])) // self.run))
        found = np.empty((2, 3, begun.stop - begun.start), np.float32)
        for side, either in enumerate(MIN_MAX):
            for axis in range(3):
                along = reduce(either, corners[axis::3])[begun.start * self.run - first :]
                along = np.pad(along, (0, -len(along) % self.run), mode="edge").reshape(-1, self.run)
                found[side, axis] = reduce(either, along.T)
        self.boxes[:, :, begun] = quantize_boxes(found)

    def build_async(self) -> "Future[BLAS]":
        """Make the tree, beside whatever else is done."""
        if self.future is None:
            core = ThreadPoolExecutor(1)
            self.future = core.submit(blas_of_runs, self.boxes, self.count)
            core.shutdown(wait=False)
        return self.future

    @property
    def blas(self) -> BLAS:
        """When it is made. Raises whatever that fails in, such as MemoryError; then it is tried again the next time."""
        try:
            made = self.build_async().result()
        except BaseException:
            self.future = None
            raise
        self.boxes = self.boxes[:, :, :0].copy()
        return made


def build_blas(mesh: Mesh) -> BLAS | DeferredBLAS:
    """The tree of a mesh that has triangles, or what will have it."""
    quantization = Quantization.of(mesh)
    if len(mesh.triangles) > SORT_ALL_BELOW and is_coherent(mesh, quantization):
        return DeferredBLAS(quantization, len(mesh.triangles))
    return blas_of_triangles(quantization.quantize(mesh.positions, np.float32), mesh.triangles)


def is_coherent(mesh: Mesh, quantization: Quantization) -> bool:
    """Whether the triangles of some of a mesh's runs do."""
    run, count = run_of(len(mesh.triangles)), len(mesh.triangles)
    some = mesh.triangles[: count // run * run].reshape(-1, run, 3)[:: -(-count // SAMPLED_TRIANGLES)]
    corners = quantization.quantize(mesh.positions[some.ravel()], np.float32).reshape(3, -1, 3)
    inside = surfaces(corners.min(2), corners.max(2)).reshape(-1, run).sum(1)
    of_runs = corners.reshape(3, -1, 3 * run)
    return bool(np.mean(surfaces(of_runs.min(2), of_runs.max(2)) <= MAX_OVERLAP * inside) >= COHERENT_FRACTION)


def blas_of_triangles(quanta: np.ndarray, triangles: np.ndarray) -> BLAS:
    """Sorted triangle by triangle; quanta are (3,V)."""
    tree = build(boxes_of(quanta, triangles), TRIANGLES_PER_LEAF)
    real = tree.order < len(triangles)
    filled = np.count_nonzero(real.reshape(tree.leaves, -1), 1)
    # A leaf that is not full looks at some of the next one's triangles too, or the last at its neighbour's.
    starts = np.minimum(np.cumsum(filled) - filled, len(triangles) - tree.per_leaf)
    order = tree.order[real].astype(np.uint32)
    return BLAS(bounds_of(tree.nodes), packed(tree.nodes), starts.astype(np.uint32), tree.per_leaf, order)


def blas_of_runs(boxes: np.ndarray, count: int) -> BLAS:
    """Over the boxes (2,3,R) of runs of `count` triangles that stay where they are."""
    run, members = run_of(count), assign_leaves(boxes, leaves_for(count, TRIANGLES_PER_LEAF))
    rows, nodes = packed_nodes_over(boxes, members)
    starts = np.minimum(members * run, count - run).astype(np.uint32)
    return BLAS(bounds_of(nodes), rows, starts, run, None)


def run_of(count: int) -> int:
    """Triangles in a run, of so many in all: no quad's two are in different ones."""
    return 2 * -(-count // (2 * leaves_for(count, TRIANGLES_PER_LEAF)))


def boxes_of(quanta: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(2,3,T) int16: boxes around triangles (T,3) of quanta (3,V), in planes."""
    boxes = np.empty((2, 3, len(triangles)), np.int16)

    def find(first: int) -> None:
        part = slice(first, first + TRIANGLES_AT_A_TIME)
        places = quanta.take(np.ascontiguousarray(triangles[part].T), 1)
        boxes[:, :, part] = quantize_boxes(np.stack([places.min(1), places.max(1)]))

    parallel_map(find, range(0, len(triangles), TRIANGLES_AT_A_TIME), len(triangles))
    return boxes


def surfaces(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """(N,) half the surface of boxes from (3,N) to (3,N): in proportion to it rays meet them."""
    x, y, z = high - low
    return x * y + y * z + z * x


def bounds_of(nodes: np.ndarray) -> np.ndarray:
    """BLAS.bounds of BVH.nodes."""
    level = min(BOXES_PER_MESH, nodes.shape[2] // 2)
    boxes = nodes[:, :, level : 2 * level].transpose(2, 0, 1)
    boxes = boxes[boxes[:, 0, 0] <= boxes[:, 1, 0]] * np.float32(QUANTA_PER_PLANE)
    return boxes[np.arange(level) % len(boxes)]
