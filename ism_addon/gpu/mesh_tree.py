# SPDX-License-Identifier: GPL-3.0-or-later
"""The tree of one mesh, and the order in which its triangles lie on the GPU, so that those of a leaf are neighbours.

Triangles that follow one another in a mesh mostly lie together too. Where they do, a leaf is a run of them as they are,
and what is sorted is runs, or runs of runs: a million triangles are ordered like some ten thousand boxes.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import reduce

import numpy as np

from ..scene import Mesh
from .lattice import Lattice
from .tree import NOWHERE, build, in_leaves, leaves_for, nodes_over, packed

#: Most triangles in a leaf: fewer make larger trees, more are tested in vain.
TRIANGLES_PER_LEAF = 4

#: Meshes of so few triangles are sorted one by one: rays are quicker, by a tenth in the atrium's statue.
FEW = 1 << 17

#: Most triangles in a leaf of other meshes; an even number, as quads are two.
TRIANGLES_PER_RUN = 6

#: Triangles that are looked at to see whether neighbours in a mesh lie together.
SOME = 1 << 14

#: Runs, or runs of runs, that are sorted: more of them are taken together, as long as they are no LOOSE ones.
MANY = 1 << 16

#: Neighbours in a mesh lie together where the box around them has this many times the surface of their own boxes at
#: most, and mostly is: grids' rows have ends. More, and rays take long; less, and sorting does.
LOOSE, MOSTLY = 3.0, 0.9

#: Boxes of a mesh by which its instances are bounded; a power of two.
PARTS = 32

#: Leaves whose boxes are found at a time: so many stay in a processor's cache.
PORTION = 1 << 13


@dataclass(frozen=True, eq=False)
class MeshTree:
    """A mesh's tree in its lattice's steps, and where its leaves' triangles are."""

    lattice: Lattice
    parts: np.ndarray  # (PARTS,2,3) steps: boxes around all of the mesh, closer than one box when it is turned
    nodes: np.ndarray  # (leaves // 2,) NODE
    starts: np.ndarray  # (leaves,) uint32: the first triangle of each leaf
    per_leaf: int  # triangles from there on that a leaf looks at
    order: np.ndarray | None  # (T,) uint32: which triangle of the mesh is where; None: all are where they were

    @property
    def leaves(self) -> int:
        """How many there are."""
        return len(self.starts)


def mesh_tree(mesh: Mesh) -> MeshTree:
    """The tree of a mesh that has triangles."""
    lattice = Lattice.of(mesh)
    steps = lattice.steps(mesh.positions, np.float32)
    count = len(mesh.triangles)
    if count > FEW:
        run = run_of(count)
        boxes, every = boxes_of_runs(steps, mesh.triangles, run), -(-count // SOME)
        some = mesh.triangles[: count // run * run].reshape(-1, run, 3)[::every]
        if together(boxes[..., : count // run : every], boxes_of_runs(steps, some.reshape(-1, 3), 1)):
            return tree_of_runs(lattice, boxes, count)
    return tree_of_triangles(lattice, steps, mesh.triangles)


def tree_of_triangles(lattice: Lattice, steps: np.ndarray, triangles: np.ndarray) -> MeshTree:
    """Sorted triangle by triangle; steps are (3,V)."""
    tree = build(boxes_of_runs(steps, triangles, 1), TRIANGLES_PER_LEAF)
    real = tree.order < len(triangles)
    filled = np.count_nonzero(real.reshape(tree.leaves, -1), 1)
    # A leaf that is not full looks at some of the next one's triangles too, or the last at its neighbour's.
    starts = np.minimum(np.cumsum(filled) - filled, len(triangles) - tree.per_leaf)
    order = tree.order[real].astype(np.uint32)
    return MeshTree(lattice, parts_of(tree.nodes), packed(tree.nodes), starts.astype(np.uint32), tree.per_leaf, order)


def tree_of_runs(lattice: Lattice, boxes: np.ndarray, count: int) -> MeshTree:
    """Over the boxes (2,3,R) of runs of `count` triangles that stay where they are."""
    run, groups, size = run_of(count), boxes, 1
    while groups.shape[2] > MANY and together(larger := fours(groups), groups):
        groups, size = larger, 4 * size
    order = in_leaves(groups, leaves_for(count, TRIANGLES_PER_RUN) // size)
    members = np.minimum((order[:, None] * size + np.arange(size)).reshape(-1), boxes.shape[2])
    nodes = nodes_over(boxes, members)
    starts = np.minimum(members * run, count - run).astype(np.uint32)
    return MeshTree(lattice, parts_of(nodes), packed(nodes), starts, run, None)


def run_of(count: int) -> int:
    """Triangles in a run, of so many in all: no quad's two are in different ones."""
    return 2 * -(-count // (2 * leaves_for(count, TRIANGLES_PER_RUN)))


def boxes_of_runs(steps: np.ndarray, triangles: np.ndarray, run: int) -> np.ndarray:
    """(2,3,R) float32: low and high corners around each `run` triangles (T,3) of steps (3,V); the last may be fewer."""
    whole = len(triangles) // run
    boxes = np.empty((2, 3, -(-len(triangles) // run)), np.float32)
    corners = triangles[: whole * run].reshape(whole, 3 * run)

    def find(first: int) -> None:
        part = slice(first, min(first + PORTION, whole))
        of_part = np.ascontiguousarray(corners[part].T)
        for axis, along in enumerate(steps):
            places = along.take(of_part)
            np.minimum.reduce(places, 0, out=boxes[0, axis, part])
            np.maximum.reduce(places, 0, out=boxes[1, axis, part])

    with ThreadPoolExecutor() as cores:
        list(cores.map(find, range(0, whole, PORTION)))
    if whole < boxes.shape[2]:
        rest = steps.take(triangles[whole * run :].ravel(), 1)
        boxes[0, :, whole], boxes[1, :, whole] = rest.min(1), rest.max(1)
    return boxes


def fours(boxes: np.ndarray) -> np.ndarray:
    """Boxes (2,3,R) around four after four."""
    boxes = np.pad(boxes, ((0, 0), (0, 0), (0, -boxes.shape[2] % 4)), mode="edge")
    four = [boxes[..., k::4] for k in range(4)]
    return np.stack([reduce(np.minimum, (box[0] for box in four)), reduce(np.maximum, (box[1] for box in four))])


def together(around: np.ndarray, inside: np.ndarray) -> bool:
    """Whether neighbours do, by boxes (2,3,N) and those inside them one after the other; the last may hold fewer."""
    of_all = -(-inside.shape[2] // around.shape[2])
    whole = inside.shape[2] // of_all
    inner = surfaces(inside[..., : whole * of_all]).reshape(whole, of_all).sum(1)
    return bool(np.mean(surfaces(around[..., :whole]) <= LOOSE * inner) >= MOSTLY)


def surfaces(boxes: np.ndarray) -> np.ndarray:
    """(N,) half the surface of boxes (2,3,N): in proportion to it rays meet them."""
    x, y, z = boxes[1] - boxes[0]
    return x * y + y * z + z * x


def parts_of(nodes: np.ndarray) -> np.ndarray:
    """MeshTree.parts of Tree.nodes."""
    level = min(PARTS, len(nodes) // 2)
    boxes = nodes[level : 2 * level]
    boxes = boxes[boxes[:, 0, 0] < NOWHERE]
    return boxes[np.arange(PARTS) % len(boxes)]
