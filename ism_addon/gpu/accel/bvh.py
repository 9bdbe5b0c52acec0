# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounding volume hierarchies (BVH) over boxes.

The tree is complete, so it needs no pointers: node k has the children 2k and 2k + 1, the root is 1, and the number
of leaves is a power of four. Each node splits its boxes at the median of their centres along the longest axis (Kay &
Kajiya 1986), all nodes of a level at once. Traversal descends two levels at a time, from k to 4k … 4k + 3, and
fetches 32 bytes for it: four boxes with 8-bit coordinates, relative to the box around all four (Ylitie, Karras & Laine
2017). Lengths are in quanta, see quantization.py. Corners of boxes lie on grid planes, 512 quanta apart, with 16-bit
indices.
"""

from dataclasses import dataclass
from functools import reduce
from itertools import repeat

import numpy as np

from ...parallel import MIN_PARALLEL_SIZE, parallel_map

#: Largest length of a short row: numpy's reductions are slow along short rows.
SHORT_ROW = 1 << 8

#: Largest length of a row for which a radix sort takes longer than a sort by comparison.
TINY_ROW = 1 << 5

#: Nodes that are packed at a time, so that they stay in the processor's cache.
BOXES_AT_A_TIME = 1 << 13

#: The empty box (2,3,1): its low corner is above its high one.
EMPTY_BOX = np.repeat(np.array([[[32767]], [[-32768]]], np.int16), 3, 1)

#: The functions that join boxes: one for low corners, and one for high ones.
MIN_MAX: tuple[np.ufunc, np.ufunc] = np.minimum, np.maximum

#: Quanta between grid planes.
QUANTA_PER_PLANE = 512

#: Quanta by which boxes are enlarged: more than the rounding error of rays whose distance is the BVH's size.
BOX_SLACK = 32

#: Quanta of a BVH's grid on either side of its origin: almost the largest integer that float32 represents. The corners
#: of enlarged boxes are not beyond the last planes.
GRID_EXTENT = 255 * 128 * QUANTA_PER_PLANE - 2 * BOX_SLACK

#: A node as shaders read it, two texels: the low corner of its box, in planes; for each axis, four bits with the
#: exponent of a unit, a power of two; and the four boxes two levels below, in these units, relative to the low corner.
BVH_NODE = np.dtype(
    [("origin", "<i2", 3), ("exponent", "<u2"), ("child_min", "u1", (3, 4)), ("child_max", "u1", (3, 4))]
)

#: By number of planes: the smallest exponent of two in whose units a byte can hold that number.
EXPONENTS = np.ceil(np.log2(np.maximum(np.arange(1 << 16) / 255.0, 1.0))).astype(np.uint16)


@dataclass(frozen=True)
class BVH:
    """The boxes in each leaf, and the bounding box of each node."""

    order: np.ndarray  # (leaves * boxes_per_leaf,) int64: indices of boxes, leaf by leaf; N where a leaf is not full
    leaves: int  # their count
    nodes: np.ndarray  # (2,3,2 * leaves) int16: bounding boxes by node, in planes

    @property
    def boxes_per_leaf(self) -> int:
        """The maximum of all leaves."""
        return len(self.order) // self.leaves


def quantize_boxes(boxes: np.ndarray) -> np.ndarray:
    """(2,3,N) int16 planes: boxes (2,3,N) float32 quanta, enlarged."""
    planes = np.empty(boxes.shape, np.int16)
    planes[0] = np.floor((boxes[0] - np.float32(BOX_SLACK)) * np.float32(1.0 / QUANTA_PER_PLANE))
    planes[1] = np.ceil((boxes[1] + np.float32(BOX_SLACK)) * np.float32(1.0 / QUANTA_PER_PLANE))
    return planes


def build(boxes: np.ndarray, max_per_leaf: int) -> BVH:
    """The BVH over N > 0 boxes (2,3,N) in planes."""
    leaves = leaves_for(boxes.shape[2], max_per_leaf)
    order = assign_leaves(boxes, leaves)
    boxes, in_leaf = np.append(boxes, EMPTY_BOX, 2), order.reshape(leaves, -1).T
    low, high = (reduce(min_or_max, map(boxes[k].take, in_leaf, repeat(1))) for k, min_or_max in enumerate(MIN_MAX))
    return BVH(order, leaves, node_boxes(np.stack([low, high]), np.arange(leaves)))


def leaves_for(count: int, max_per_leaf: int) -> int:
    """Number of leaves for `count` boxes: the smallest power of four that is enough."""
    return 4 ** int(np.ceil(np.log2(max(count / max_per_leaf, 1.0)) / 2.0))


def assign_leaves(boxes: np.ndarray, leaves: int) -> np.ndarray:
    """(leaves * boxes_per_leaf,) int64: indices of boxes (2,3,N), leaf by leaf; N where a leaf is not full."""
    count = boxes.shape[2]
    per_leaf = -(-count // leaves)
    order = np.minimum(np.arange(leaves * per_leaf), count)
    centres = ((boxes[0] >> 1) + (boxes[1] >> 1)).take(order[None], 1, mode="clip")
    groups = [(centres, order[None])]
    if leaves > 1 and count > MIN_PARALLEL_SIZE:
        centres, halves = split(*groups[0])
        groups = [(centres[:, half : half + 1], halves[half : half + 1]) for half in (0, 1)]
    size = 4 if per_leaf == 1 else per_leaf  # traversal tests four leaves at once, so their order does not matter
    return np.concatenate(parallel_map(lambda group: sort(*group, size), groups, count))


def node_boxes(boxes: np.ndarray, members: np.ndarray) -> np.ndarray:
    """(2,3,2 * leaves): BVH.nodes over leaves that hold one box of (2,3,N) each: `members` are indices, N for none."""
    leaves, is_empty = len(members), members == boxes.shape[2]
    nodes = np.empty((2, 3, 2 * leaves), np.int16)

    def fill(side: int, axis: int) -> None:
        coordinates, min_or_max, empty = nodes[side, axis], MIN_MAX[side], EMPTY_BOX[side, axis]
        boxes[side, axis].take(members, out=coordinates[leaves:], mode="clip")
        np.copyto(coordinates[leaves:], empty, where=is_empty)
        first = leaves // 2
        while first:
            children = coordinates[2 * first : 4 * first]
            min_or_max(children[::2], children[1::2], out=coordinates[first : 2 * first])
            first //= 2
        coordinates[0] = empty[0]

    parallel_map(lambda side_and_axis: fill(*side_and_axis), np.ndindex(2, 3), leaves)
    return nodes


def scale_of(extent: np.ndarray) -> np.ndarray:
    """(3,) float32: quanta per unit of length, for a grid that extends by `extent` (3,) to either side of its origin.

    Flat extents are enlarged, so that products do not overflow.
    """
    return np.float32(GRID_EXTENT) / np.maximum(extent, max(1e-3 * extent.max(), 1e-20)).astype(np.float32)


def packed(nodes: np.ndarray) -> np.ndarray:
    """(leaves // 2,) BVH_NODE of every other level, which traversal visits: rounded outwards, empty boxes inverted."""
    rows = np.zeros(nodes.shape[2] // 4, BVH_NODE)
    levels = [4**k for k in range(15) if 4**k < len(rows)]
    chunks = [
        slice(first, min(first + BOXES_AT_A_TIME, 2 * level))
        for level in levels
        for first in range(level, 2 * level, BOXES_AT_A_TIME)
    ]
    parallel_map(
        lambda chunk: pack(nodes[..., grandchildren(chunk)], nodes[..., chunk], rows[chunk]), chunks, len(rows)
    )
    return rows


def packed_nodes_over(boxes: np.ndarray, members: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """packed(node_boxes(boxes, members)) for 16 leaves or more, and the nodes without the two lowest levels.

    The two lowest levels would take most of the memory, so they are computed and packed in portions.
    """
    leaves, above = len(members), len(members) // 4
    rows, parents = np.zeros(leaves // 2, BVH_NODE), np.empty((2, 3, above), np.int16)

    def fill(first: int) -> None:
        chunk = slice(first, min(first + BOXES_AT_A_TIME, above))
        indices = members[grandchildren(chunk)]
        leaf_boxes = boxes.take(indices, 2, mode="clip")
        np.copyto(leaf_boxes, EMPTY_BOX, where=indices == boxes.shape[2])
        for side, min_or_max in enumerate(MIN_MAX):
            parents[side, :, chunk] = reduce(min_or_max, (leaf_boxes[side, :, k::4] for k in range(4)))
        pack(leaf_boxes, parents[:, :, chunk], rows[above:][chunk])

    parallel_map(fill, range(0, above, BOXES_AT_A_TIME), leaves)
    nodes = node_boxes(parents, np.arange(above))
    rows[: above // 2] = packed(nodes)
    return rows, nodes


def grandchildren(nodes: slice) -> slice:
    """The indices of the nodes two levels below these."""
    return slice(4 * nodes.start, 4 * nodes.stop)


def pack(boxes: np.ndarray, parents: np.ndarray, rows: np.ndarray) -> None:
    """Fill rows (N,) BVH_NODE with boxes (2,3,4 N) of four children each of parents (2,3,N)."""
    origin = parents[0]
    # Differences of int16 wrap around, and are correct as uint16.
    exponents = EXPONENTS.take((parents[1] - origin).view(np.uint16))
    rows["origin"], rows["exponent"] = origin.T, exponents[0] + 16 * exponents[1] + 256 * exponents[2]
    low, high = (boxes - np.repeat(origin, 4, 1)).view(np.uint16)
    exponents = np.repeat(exponents, 4, 1)
    low, high = low >> exponents, high + ((np.uint16(1) << exponents) - np.uint16(1)) >> exponents
    is_empty = boxes[0, 0] > boxes[1, 0]
    low[:, is_empty], high[:, is_empty] = 255, 0
    words = rows.view(np.uint32).reshape(-1, 8)  # four bytes at a time, as numpy is slow along short axes
    words[:, 2:5], words[:, 5:] = (corner.astype(np.uint8).view(np.uint32).T for corner in (low, high))


def sort(centres: np.ndarray, groups: np.ndarray, size: int) -> np.ndarray:
    """Split boxes (1,N) with centres (3,1,N) until rows have `size` boxes; N is `size` times a power of two."""
    while groups.shape[1] > size:
        centres, groups = split(centres, groups)
    return groups.ravel()


def split(centres: np.ndarray, groups: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Split each row of groups (G,N) at the median along its longest axis, the lower half first, and centres (3,G,N).

    Centres are sorted like their boxes, so that memory is read in order.
    """
    count, size = groups.shape
    longest = (reduce_rows(np.maximum, centres) - reduce_rows(np.minimum, centres)).view(np.uint16).argmax(0)
    order = ascending(centres[longest, np.arange(count)])
    order += np.arange(0, count * size, size)[:, None]
    order = order.reshape(2 * count, size // 2)
    return centres.reshape(3, -1).take(order, 1), groups.ravel().take(order)


def ascending(values: np.ndarray) -> np.ndarray:
    """(G,N) int64: np.argsort of values (G,N) int16 along rows.

    It is faster than np.argpartition, because numpy sorts 16-bit integers by radix. The keys of short rows have their
    indices in the lower bits.
    """
    size = values.shape[1]
    if size > TINY_ROW:
        return np.argsort(values, axis=1, kind="stable")
    keys = values.astype(np.int32) << 16 | np.arange(size, dtype=np.int32)
    keys.sort(axis=1)
    return (keys & 0xFFFF).astype(np.int64)


def reduce_rows(min_or_max: np.ufunc, centres: np.ndarray) -> np.ndarray:
    """(3,G): the minimum or maximum of each row of centres (3,G,N)."""
    rows, size = centres.shape[:2], centres.shape[2]
    while size <= SHORT_ROW and size % 2 == 0:
        centres, size = centres.reshape(-1), size // 2
        centres = min_or_max(centres[::2], centres[1::2])
    return min_or_max.reduce(centres.reshape(*rows, size), 2)
