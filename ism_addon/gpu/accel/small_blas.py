# SPDX-License-Identifier: GPL-3.0-or-later
"""The bottom-level BVHs of many meshes: those of small ones are built together, with the same result as one by one.

BVHs of the same number of leaves and of triangles per leaf are rows of the same arrays.
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
    order = sorted(range(len(meshes)), key=counts.__getitem__)  # so that a group has few shapes
    groups = [order[group] for group in small_mesh_groups([counts[index] for index in order])]

    def build_group(group: list[int]) -> Sequence[BLAS | DeferredBLAS]:
        grouped = [meshes[index] for index in group]
        return blas_of_small_meshes(grouped) if len(grouped) > 1 else [build_blas(grouped[0])]

    built = dict(zip(order, chain.from_iterable(parallel_map(build_group, groups, sum(counts))), strict=True))
    return [built[index] for index in range(len(meshes))]


def blas_of_small_meshes(meshes: Sequence[Mesh]) -> list[BLAS]:
    """The BVHs of small meshes."""
    joined = JoinedMeshes(meshes)
    boxes = boxes_of(joined.quantize(np.float32), joined.triangles)
    leaves = {count: leaves_for(count, TRIANGLES_PER_LEAF) for count in set(joined.counts.tolist())}
    shapes: dict[tuple[int, int], list[int]] = {}
    for index, count in enumerate(joined.counts.tolist()):
        shapes.setdefault((leaves[count], -(-count // leaves[count])), []).append(index)
    built: dict[int, BLAS] = {}
    for shape, indices in shapes.items():
        trees = blas_of_shape(boxes, joined.first[indices], joined.counts[indices], *shape)
        built.update(zip(indices, trees, strict=True))
    return [built[index] for index in range(len(meshes))]


def blas_of_shape(boxes: np.ndarray, first: np.ndarray, counts: np.ndarray, leaves: int, per_leaf: int) -> list[BLAS]:
    """M BVHs of so many leaves each over boxes (2,3,N) in planes: `counts` (M,) of them for each, from `first` (M,) on.

    The same as bvh.build and bvh.packed of each.
    """
    number, count = len(first), counts[:, None]
    order = np.minimum(np.arange(leaves * per_leaf), count)
    chosen = boxes.take(first[:, None] + np.minimum(order, count - 1), 2)
    centres = (chosen[0] >> 1) + (chosen[1] >> 1)
    order = sort(centres, order, 4 if per_leaf == 1 else per_leaf).reshape(number, -1)
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
    """(2,3,M,2 * leaves): BVH.nodes of M BVHs, whose leaves hold boxes (2,3,M,leaves,per_leaf)."""
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
    """(M,leaves // 2) BVH_NODE of nodes (2,3,M,2 * leaves): see bvh.packed."""
    number, leaves = nodes.shape[2], nodes.shape[3] // 2
    rows = np.zeros((number, leaves // 2), BVH_NODE)
    level = 1
    while level < leaves // 2:
        boxes, parents = nodes[..., 4 * level : 8 * level], nodes[..., level : 2 * level]
        of_level = np.empty(number * level, BVH_NODE)
        pack(boxes.reshape(2, 3, -1), parents.reshape(2, 3, -1), of_level)
        rows[:, level : 2 * level] = of_level.reshape(number, level)
        level *= 4
    return rows


def bounds_of(nodes: np.ndarray) -> np.ndarray:
    """(M,P,2,3) BLAS.bounds of nodes (2,3,M,2 * leaves)."""
    level = min(BOXES_PER_MESH, nodes.shape[3] // 2)
    boxes = nodes[..., level : 2 * level].transpose(2, 3, 0, 1)
    real = boxes[:, :, 0, 0] <= boxes[:, :, 1, 0]
    chosen = np.argsort(~real, axis=1, kind="stable")
    repeated = np.arange(level) % real.sum(1, keepdims=True)
    chosen = np.take_along_axis(chosen, repeated, 1)
    return np.take_along_axis(boxes, chosen[:, :, None, None], 1) * np.float32(QUANTA_PER_PLANE)
