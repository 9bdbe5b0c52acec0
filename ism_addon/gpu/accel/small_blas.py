# SPDX-License-Identifier: GPL-3.0-or-later
"""The trees of many meshes: those of small ones are made together, and are the same as of each by itself.

Trees of one shape, of so many leaves that hold so many triangles, are rows of the same arrays.
"""

from collections.abc import Sequence
from functools import reduce
from itertools import chain

import numpy as np

from ...parallel import parallel_map
from ...scene import Mesh
from ..buffers.small_meshes import JoinedMeshes, small_mesh_groups
from .blas import BLAS, BOXES_PER_MESH, TRIANGLES_PER_LEAF, DeferredBLAS, boxes_of, build_blas
from .bvh import BVH_NODE, EMPTY_BOX, MIN_MAX, QUANTA_PER_PLANE, leaves_for, pack, sort


def build_all_blas(meshes: Sequence[Mesh]) -> list[BLAS | DeferredBLAS]:
    """build_blas of each mesh, on all cores."""
    counts = [len(mesh.triangles) for mesh in meshes]
    order = sorted(range(len(meshes)), key=counts.__getitem__)  # neighbours are alike
    groups = [order[group] for group in small_mesh_groups([counts[number] for number in order])]

    def made(group: list[int]) -> Sequence[BLAS | DeferredBLAS]:
        some = [meshes[number] for number in group]
        return blas_of_small_meshes(some) if len(some) > 1 else [build_blas(some[0])]

    found = dict(zip(order, chain.from_iterable(parallel_map(made, groups, sum(counts))), strict=True))
    return [found[number] for number in range(len(meshes))]


def blas_of_small_meshes(meshes: Sequence[Mesh]) -> list[BLAS]:
    """Those of meshes that are small enough to be put together."""
    together = JoinedMeshes(meshes)
    boxes = boxes_of(together.quantize(np.float32), together.triangles)
    leaves = {count: leaves_for(count, TRIANGLES_PER_LEAF) for count in set(together.counts.tolist())}
    shapes: dict[tuple[int, int], list[int]] = {}
    for number, count in enumerate(together.counts.tolist()):
        shapes.setdefault((leaves[count], -(-count // leaves[count])), []).append(number)
    made: dict[int, BLAS] = {}
    for shape, numbers in shapes.items():
        trees = blas_of_shape(boxes, together.first[numbers], together.counts[numbers], *shape)
        made.update(zip(numbers, trees, strict=True))
    return [made[number] for number in range(len(meshes))]


def blas_of_shape(boxes: np.ndarray, first: np.ndarray, counts: np.ndarray, leaves: int, per_leaf: int) -> list[BLAS]:
    """Trees of so many leaves each over boxes (2,3,N) in planes: `counts` (M,) of them for each, from `first` (M,) on.

    The same as build and packed make one by one.
    """
    number, count = len(first), counts[:, None]
    order = np.minimum(np.arange(leaves * per_leaf), count)
    chosen = boxes.take(first[:, None] + np.minimum(order, count - 1), 2)
    middles = (chosen[0] >> 1) + (chosen[1] >> 1)
    order = sort(middles, order, 4 if per_leaf == 1 else per_leaf).reshape(number, -1)
    real = order < count
    inside = boxes.take(first[:, None] + np.minimum(order, count - 1), 2)
    np.copyto(inside, EMPTY_BOX[..., None], where=~real)
    nodes = node_boxes(inside.reshape(2, 3, number, leaves, per_leaf))
    filled = real.reshape(number, leaves, per_leaf).sum(2)
    starts = np.minimum(np.cumsum(filled, 1) - filled, count - per_leaf).astype(np.uint32)
    ends = np.cumsum(counts).tolist()
    orders = np.split(order[real].astype(np.uint32), ends[:-1])
    trees = zip(bounds_of(nodes), packed(nodes), starts, orders, strict=True)
    return [BLAS(bounds, rows, begins, per_leaf, own) for bounds, rows, begins, own in trees]


def node_boxes(inside: np.ndarray) -> np.ndarray:
    """(2,3,M,2 * leaves): Tree.nodes of each of M trees, whose leaves hold boxes (2,3,M,leaves,per_leaf)."""
    _, _, number, leaves, per_leaf = inside.shape
    nodes = np.empty((2, 3, number, 2 * leaves), np.int16)
    nodes[..., 0] = EMPTY_BOX
    for along, either, of_side in zip(nodes, MIN_MAX, inside, strict=True):
        along[..., leaves:] = reduce(either, (of_side[..., k] for k in range(per_leaf)))
        level = leaves
        while level > 1:
            children, level = along[..., level : 2 * level], level // 2
            along[..., level : 2 * level] = either(children[..., ::2], children[..., 1::2])
    return nodes


def packed(nodes: np.ndarray) -> np.ndarray:
    """(M,leaves // 2) BVH_NODE of trees' nodes (2,3,M,2 * leaves), as tree.packed has them."""
    number, leaves = nodes.shape[2], nodes.shape[3] // 2
    rows = np.zeros((number, leaves // 2), BVH_NODE)
    level = 1
    while level < leaves // 2:
        inside, around = nodes[..., 4 * level : 8 * level], nodes[..., level : 2 * level]
        of_level = np.empty(number * level, BVH_NODE)
        pack(inside.reshape(2, 3, -1), around.reshape(2, 3, -1), of_level)
        rows[:, level : 2 * level] = of_level.reshape(number, level)
        level *= 4
    return rows


def bounds_of(nodes: np.ndarray) -> np.ndarray:
    """(M,P,2,3) BLAS.bounds of trees' nodes (2,3,M,2 * leaves)."""
    level = min(BOXES_PER_MESH, nodes.shape[3] // 2)
    boxes = nodes[..., level : 2 * level].transpose(2, 3, 0, 1)
    real = boxes[:, :, 0, 0] <= boxes[:, :, 1, 0]
    chosen = np.argsort(~real, axis=1, kind="stable")
    turns = np.arange(level) % real.sum(1, keepdims=True)
    chosen = np.take_along_axis(chosen, turns, 1)
    return np.take_along_axis(boxes, chosen[:, :, None, None], 1) * np.float32(QUANTA_PER_PLANE)
