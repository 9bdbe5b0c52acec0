# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounding volume hierarchies (BVH) over boxes.

The tree is complete, so that it needs no pointers: node k has the children 2k and 2k + 1, the root is 1, and the number
of leaves is a power of four. Each node splits its boxes at the median of their centres along the longest axis (Kay &
Kajiya 1986), all nodes of a level at once. Traversal takes two levels at a step, from k to 4k … 4k + 3, and fetches 32
bytes for it: four boxes with corners of a byte, relative to the box around all four (Ylitie, Karras & Laine 2017).
Lengths are in quanta, see quantization.py. Corners of boxes lie on grid planes, 512 quanta apart, with 16-bit indices.
"""

from dataclasses import dataclass
from functools import reduce
from itertools import repeat

import numpy as np

from ...parallel import MIN_PARALLEL_SIZE, parallel_map

#: Up to so many boxes a row is short: numpy's reductions are slow along it.
SHORT_ROW = 1 << 8

#: Up to so many a radix sort takes longer than a sort by comparison.
TINY_ROW = 1 << 5

#: Nodes that are packed at a time, so that they stay in the processor's cache.
BOXES_AT_A_TIME = 1 << 13

#: The empty box (2,3,1): its low corner is above its high one.
EMPTY_BOX = np.repeat(np.array([[[32767]], [[-32768]]], np.int16), 3, 1)

#: What joins boxes: of their low corners, and of their high ones.
MIN_MAX: tuple[np.ufunc, np.ufunc] = np.minimum, np.maximum

#: Quanta between grid planes.
QUANTA_PER_PLANE = 512

#: Quanta by which boxes are enlarged: more than the rounding error of rays that start as far away as the BVH is large.
BOX_SLACK = 32

#: Quanta of a BVH's grid on either side of its origin: nearly the largest integer of float32. Enlarged boxes still end
#: on the last planes.
GRID_EXTENT = 255 * 128 * QUANTA_PER_PLANE - 2 * BOX_SLACK

#: A node as shaders read it, two texels: the low corner of its box, in planes; the unit of its children on each axis,
#: as an exponent of two, four bits an axis; and the four boxes two levels below, in that unit, relative to the low
#: corner.
BVH_NODE = np.dtype(
    [("origin", "<i2", 3), ("exponent", "<u2"), ("child_min", "u1", (3, 4)), ("child_max", "u1", (3, 4))]
)

#: The smallest exponent of two in whose units a byte holds so many planes.
POWERS = np.ceil(np.log2(np.maximum(np.arange(1 << 16) / 255.0, 1.0))).astype(np.uint16)


@dataclass(frozen=True)
class BVH:
    """The boxes of each leaf, and the bounds of each node."""

    order: np.ndarray  # (leaves * boxes_per_leaf,) int64: boxes, leaf by leaf; their number where a leaf is not full
    leaves: int
    nodes: np.ndarray  # (2,3,2 * leaves) int16: box of node k, in planes

    @property
    def boxes_per_leaf(self) -> int:
        """The most of any leaf."""
        return len(self.order) // self.leaves


def quantize_boxes(boxes: np.ndarray) -> np.ndarray:
    """(2,3,N) int16 planes: boxes (2,3,N) float32 quanta, enlarged."""
    found = np.empty(boxes.shape, np.int16)
    found[0] = np.floor((boxes[0] - np.float32(BOX_SLACK)) * np.float32(1.0 / QUANTA_PER_PLANE))
    found[1] = np.ceil((boxes[1] + np.float32(BOX_SLACK)) * np.float32(1.0 / QUANTA_PER_PLANE))
    return found


def build(boxes: np.ndarray, max_per_leaf: int) -> BVH:
    """The BVH over N > 0 boxes (2,3,N) in planes."""
    leaves = leaves_for(boxes.shape[2], max_per_leaf)
    order = assign_leaves(boxes, leaves)
    boxes, in_leaf = np.append(boxes, EMPTY_BOX, 2), order.reshape(leaves, -1).T
    low, high = (reduce(f, map(boxes[k].take, in_leaf, repeat(1))) for k, f in enumerate(MIN_MAX))
    return BVH(order, leaves, node_boxes(np.stack([low, high]), np.arange(leaves)))


def leaves_for(count: int, max_per_leaf: int) -> int:
    """The smallest power of four of leaves that hold `count` boxes."""
    return 4 ** int(np.ceil(np.log2(max(count / max_per_leaf, 1.0)) / 2.0))


def assign_leaves(boxes: np.ndarray, leaves: int) -> np.ndarray:
    """(leaves * boxes_per_leaf,) int64: indices of boxes (2,3,N), leaf by leaf; N where a leaf is not full."""
    count = boxes.shape[2]
    per_leaf = -(-count // leaves)
    order = np.minimum(np.arange(leaves * per_leaf), count)
    centres = ((boxes[0] >> 1) + (boxes[1] >> 1)).take(order[None], 1, mode="clip")
    halves = [(centres, order[None])]
    if leaves > 1 and count > MIN_PARALLEL_SIZE:
        centres, both = split(*halves[0])
        halves = [(centres[:, half : half + 1], both[half : half + 1]) for half in (0, 1)]
    size = 4 if per_leaf == 1 else per_leaf  # traversal tests four leaves at a step, so their order does not matter
    return np.concatenate(parallel_map(lambda half: sort(*half, size), halves, count))


def node_boxes(boxes: np.ndarray, members: np.ndarray) -> np.ndarray:
    """(2,3,2 * leaves): BVH.nodes over leaves that hold a box (2,3,N) each, by index; N for none."""
    leaves, empty = len(members), members == boxes.shape[2]
    nodes = np.empty((2, 3, 2 * leaves), np.int16)

    def fill(side: int, axis: int) -> None:
        along, either, empty_side = nodes[side, axis], MIN_MAX[side], EMPTY_BOX[side, axis]
        boxes[side, axis].take(members, out=along[leaves:], mode="clip")
        np.copyto(along[leaves:], empty_side, where=empty)
        first = leaves // 2
        while first:
            children = along[2 * first : 4 * first]
            either(children[::2], children[1::2], out=along[first : 2 * first])
            first //= 2
        along[0] = empty_side[0]

    parallel_map(lambda each: fill(*each), np.ndindex(2, 3), leaves)
    return nodes


def scale_of(extent: np.ndarray) -> np.ndarray:
    """(3,) float32: quanta per unit of length of a grid that extends `extent` (3,) to either side of its origin.

    Flat extents are enlarged, so that products do not overflow.
    """
    return np.float32(GRID_EXTENT) / np.maximum(extent, max(1e-3 * extent.max(), 1e-20)).astype(np.float32)


def packed(nodes: np.ndarray) -> np.ndarray:
    """(leaves // 2,) BVH_NODE of every other level, as traversal takes them: rounded outwards, empty boxes inverted."""
    rows = np.zeros(nodes.shape[2] // 4, BVH_NODE)
    levels = [4**k for k in range(15) if 4**k < len(rows)]
    parts = [
        slice(f, min(f + BOXES_AT_A_TIME, 2 * level))
        for level in levels
        for f in range(level, 2 * level, BOXES_AT_A_TIME)
    ]
    parallel_map(lambda part: pack(nodes[..., grandchildren(part)], nodes[..., part], rows[part]), parts, len(rows))
    return rows


def packed_nodes_over(boxes: np.ndarray, members: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """packed(node_boxes(boxes, members)) for 16 leaves or more, and the nodes without the two lowest levels.

    Those would take most of the memory: they are computed and packed in portions.
    """
    leaves, above = len(members), len(members) // 4
    rows, parents = np.zeros(leaves // 2, BVH_NODE), np.empty((2, 3, above), np.int16)

    def fill(first: int) -> None:
        part = slice(first, min(first + BOXES_AT_A_TIME, above))
        chosen = members[grandchildren(part)]
        inside = boxes.take(chosen, 2, mode="clip")
        np.copyto(inside, EMPTY_BOX, where=chosen == boxes.shape[2])
        for side, either in enumerate(MIN_MAX):
            parents[side, :, part] = reduce(either, (inside[side, :, k::4] for k in range(4)))
        pack(inside, parents[:, :, part], rows[above:][part])

    parallel_map(fill, range(0, above, BOXES_AT_A_TIME), leaves)
    nodes = node_boxes(parents, np.arange(above))
    rows[: above // 2] = packed(nodes)
    return rows, nodes


def grandchildren(part: slice) -> slice:
    """The indices of the boxes two levels below some nodes."""
    return slice(4 * part.start, 4 * part.stop)


def pack(boxes: np.ndarray, parents: np.ndarray, into: np.ndarray) -> None:
    """Fill rows (N,) BVH_NODE with boxes (2,3,4 N) of four children each of parents (2,3,N)."""
    origin = parents[0]
    # Differences of int16 wrap around, and are right as uint16.
    powers = POWERS.take((parents[1] - origin).view(np.uint16))
    into["origin"], into["exponent"] = origin.T, powers[0] + 16 * powers[1] + 256 * powers[2]
    low, high = (boxes - np.repeat(origin, 4, 1)).view(np.uint16)
    powers = np.repeat(powers, 4, 1)
    low, high = low >> powers, high + ((np.uint16(1) << powers) - np.uint16(1)) >> powers
    is_empty = boxes[0, 0] > boxes[1, 0]
    low[:, is_empty], high[:, is_empty] = 255, 0
    words = into.view(np.uint32).reshape(-1, 8)  # four bytes at a time, as numpy is slow along short axes
    words[:, 2:5], words[:, 5:] = (corner.astype(np.uint8).view(np.uint32).T for corner in (low, high))


def sort(centres: np.ndarray, groups: np.ndarray, size: int) -> np.ndarray:
    """Split boxes (1,N), N a power of two times `size`, into rows of `size`; their centres are (3,1,N)."""
    while groups.shape[1] > size:
        centres, groups = split(centres, groups)
    return groups.ravel()


def split(centres: np.ndarray, groups: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Split each row of groups (G,N) at the median along its longest axis, the lower half first; with centres (3,G,N).

    Coordinates are sorted with their boxes, so that memory is read in order.
    """
    count, size = groups.shape
    longest = (reduce_rows(np.maximum, centres) - reduce_rows(np.minimum, centres)).view(np.uint16).argmax(0)
    order = ascending(centres[longest, np.arange(count)])
    order += np.arange(0, count * size, size)[:, None]
    order = order.reshape(2 * count, size // 2)
    return centres.reshape(3, -1).take(order, 1), groups.ravel().take(order)


def ascending(values: np.ndarray) -> np.ndarray:
    """(G,N) int64: np.argsort of values (G,N) int16 along rows.

    It takes less than np.argpartition: numpy sorts 16 bits by radix; short rows are sorted with their indices as one
    key.
    """
    size = values.shape[1]
    if size > TINY_ROW:
        return np.argsort(values, axis=1, kind="stable")
    keys = values.astype(np.int32) << 16 | np.arange(size, dtype=np.int32)
    keys.sort(axis=1)
    return (keys & 0xFFFF).astype(np.int64)


def reduce_rows(either: np.ufunc, centres: np.ndarray) -> np.ndarray:
    """(3,G): the minimum or maximum of each row of centres (3,G,N)."""
    rows, size = centres.shape[:2], centres.shape[2]
    while size <= SHORT_ROW and size % 2 == 0:
        centres, size = centres.reshape(-1), size // 2
        centres = either(centres[::2], centres[1::2])
    return either.reduce(centres.reshape(*rows, size), 2)
