# SPDX-License-Identifier: GPL-3.0-or-later
"""A tree of boxes over boxes: what a shadow ray looks through instead of all triangles.

Complete, so that its shape needs no pointers: node k has the children 2k and 2k + 1, the root is 1, and the leaves are
as many as the next power of four asks for. Each node splits its boxes at the median of their middles along the longest
axis (Kay & Kajiya 1986), all nodes of a level at once. Rays go two levels at a step, from k to 4k … 4k + 3: what they
fetch for that is 32 bytes, corners in bytes within the box around all four (Ylitie, Karras & Laine 2017).
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import reduce

import numpy as np

#: Where the boxes of leaves that hold nothing are: no ray gets there. m
NOWHERE = 1e30

#: Trees of more boxes than this are split by two threads (numpy lets go of the interpreter's lock).
LARGE = 1 << 14


#: Steps from one plane in which boxes may begin and end to the next: 16 bits say which, 8 where they are all of a node.
PLANE = 512

#: Steps that boxes reach beyond what is in them: more than rays err that start as far away as the tree is large.
SLACK = 32

#: Rays see a tree on a grid of so many steps on either side of the origin: as many as float32 tells apart, nearly, and
#: boxes that reach a little farther still end in the last planes.
REACH = 255 * 128 * PLANE - 2 * SLACK

#: A node as rays read it, two texels: the plane where its box begins; how many planes are the unit of the rest, as a
#: power of two of four bits an axis; and on each axis, from where to where the four boxes two levels below reach.
NODE = np.dtype([("begin", "<i2", 3), ("unit", "<u2"), ("low", "u1", (3, 4)), ("high", "u1", (3, 4))])


@dataclass(frozen=True)
class Tree:
    """Which boxes lie in which leaf, and around what."""

    order: np.ndarray  # (leaves * per_leaf,) int64: boxes, leaf by leaf; one is repeated to fill the last leaves
    leaves: int
    nodes: np.ndarray  # (2 * leaves, 2, 3) float32: low and high corner of node k

    @property
    def per_leaf(self) -> int:
        """Boxes a leaf."""
        return len(self.order) // self.leaves

    @property
    def scale(self) -> np.ndarray:
        """(3,) float32: steps of the grid a unit of length. What is flat counts as thicker, lest products overflow."""
        reach = np.abs(self.nodes[1]).max(0)
        return np.float32(REACH) / np.maximum(reach, max(1e-3 * reach.max(), 1e-20))

    def steps(self, points: np.ndarray) -> np.ndarray:
        """Points (…,3) float32 of the tree on its grid."""
        return points * self.scale

    def packed(self) -> np.ndarray:
        """(leaves // 2,) NODE: rounded outwards, and inside out where there is nothing."""
        count = self.leaves // 2
        nowhere = self.nodes[: 4 * count, 0, 0] == np.float32(NOWHERE)
        corners = self.steps(np.where(nowhere[:, None, None], np.float32(0.0), self.nodes[: 4 * count]))
        corners += np.float32([[-SLACK], [SLACK]])
        corners /= np.float32(PLANE)
        low, high = np.floor(corners[:, 0]).astype(np.int32), np.ceil(corners[:, 1]).astype(np.int32)
        begin = low[:count]
        power = np.frexp(((np.maximum(high[:count] - begin, 1) - 1) // 255).astype(np.float32))[1]
        low, high = (corner.reshape(count, 4, 3).swapaxes(1, 2) - begin[..., None] for corner in (low, high))
        nowhere = nowhere.reshape(count, 1, 4)
        packed = np.empty(count, NODE)
        packed["begin"], packed["unit"] = begin, power @ (1, 16, 256)
        packed["low"] = np.where(nowhere, 255, low >> power[..., None])
        packed["high"] = np.where(nowhere, 0, -(-high >> power[..., None]))
        return packed


def build(low: np.ndarray, high: np.ndarray, most_per_leaf: int) -> Tree:
    """A tree over N > 0 boxes, given by their corners (N,3) float32 each."""
    depth = 2 * int(np.ceil(np.log2(max(len(low) / most_per_leaf, 1.0)) / 2.0))
    leaves = 1 << depth
    per_leaf = -(-len(low) // leaves)
    count = len(low)
    order = np.minimum(np.arange(leaves * per_leaf), count)  # number `count` stands for no box
    middles = np.append(low + high, low[-1:] + high[-1:], 0).T[:, None, order]
    halves = [(middles, order[None])]
    if depth and count > LARGE:
        middles, both = split(*halves[0])
        halves = [(middles[:, half : half + 1], both[half : half + 1]) for half in (0, 1)]
    with ThreadPoolExecutor() as cores:
        order = np.concatenate(list(cores.map(lambda half: sort(*half, per_leaf), halves)))
    nodes = np.empty((2 * leaves, 2, 3), np.float32)
    nothing = np.full((1, 3), np.inf, np.float32)
    in_leaves = order.reshape(leaves, per_leaf).T  # reduced row by row: numpy is slow along short axes
    nodes[leaves:, 0] = reduce(np.minimum, map(np.append(low, nothing, 0).__getitem__, in_leaves))
    nodes[leaves:, 1] = reduce(np.maximum, map(np.append(high, -nothing, 0).__getitem__, in_leaves))
    for level in range(depth - 1, -1, -1):
        first = 1 << level
        children = nodes[2 * first : 4 * first].reshape(first, 2, 2, 3)
        nodes[first : 2 * first, 0] = np.minimum(children[:, 0, 0], children[:, 1, 0])
        nodes[first : 2 * first, 1] = np.maximum(children[:, 0, 1], children[:, 1, 1])
    nodes[0] = NOWHERE
    nodes[nodes[:, 0, 0] > nodes[:, 1, 0]] = NOWHERE
    return Tree(np.minimum(order, count - 1), leaves, nodes)


def sort(middles: np.ndarray, groups: np.ndarray, per_leaf: int) -> np.ndarray:
    """Split boxes (1,N), N a power of two times per_leaf, until each leaf has its own; their middles are (3,1,N)."""
    while groups.shape[1] > per_leaf:
        middles, groups = split(middles, groups)
    return groups.ravel()


def split(middles: np.ndarray, groups: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Each row of groups (G,N) as two, the lower half along its longest axis first; with middles (3,G,N).

    Coordinates are rows of their own, and go where their boxes go: so all that is read lies side by side.
    """
    longest = (middles.max(2) - middles.min(2)).argmax(0)
    along = middles[longest, np.arange(len(groups))]
    order = np.argpartition(along, groups.shape[1] // 2, axis=1)
    halves = 2 * len(groups), groups.shape[1] // 2
    middles = np.take_along_axis(middles, order[None], 2).reshape(3, *halves)
    return middles, np.take_along_axis(groups, order, 1).reshape(halves)
