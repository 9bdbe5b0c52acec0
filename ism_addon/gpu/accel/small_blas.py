# SPDX-License-Identifier: GPL-3.0-or-later
"""The bottom-level BVHs of many meshes. Those of small meshes are built together, with the same result as one by one.

BVHs with equal numbers of leaves and of triangles per leaf are rows of the same arrays.
"""

from collections.abc import Sequence
from functools import reduce
from itertools import chain

import numpy as np

from ...parallel import parallel_map
from ...scene import Mesh
from ..buffers.small_meshes import JoinedMeshes, small_mesh_groups
from .blas import BLAS, BOXES_PER_MESH, TRIANGLES_PER_LEAF, DeferredBLAS, build_blas, triangle_boxes
from .bvh import BVH_NODE, EMPTY_BOX, MIN_MAX, QUANTA_PER_PLANE, leaves_for, pack, sort


def build_all_blas(meshes: Sequence[Mesh]) -> list[BLAS | DeferredBLAS]:
    """build_blas of each mesh, on all cores."""
    counts = [len(mesh.triangles) for mesh in meshes]
    order = sorted(range(len(meshes)), key=counts.__getitem__)  # so that a group has few pairs of leaves and per_leaf
    groups = [order[group] for group in small_mesh_groups([counts[index] for index in order])]

    def build_group(group: list[int]) -> Sequence[BLAS | DeferredBLAS]:
        grouped = [meshes[index] for index in group]
        return blas_of_small_meshes(grouped) if len(grouped) > 1 else [build_blas(grouped[0])]

    built = dict(zip(order, chain.from_iterable(parallel_map(build_group, groups, sum(counts))), strict=True))
    return [built[index] for index in range(len(meshes))]


def blas_of_small_meshes(meshes: Sequence[Mesh]) -> list[BLAS]:
    """The BVHs of small meshes."""
    joined = JoinedMeshes(meshes)
    boxes = triangle_boxes(joined.quantize(np.float32), joined.triangles)
    leaves = {count: leaves_for(count, TRIANGLES_PER_LEAF) for count in set(joined.counts.tolist())}
    shapes: dict[tuple[int, int], list[int]] = {}
    for index, count in enumerate(joined.counts.tolist()):
        shapes.setdefault((leaves[count], -(-count // leaves[count])), []).append(index)
    built: dict[int, BLAS] = {}
    for shape, indices in shapes.items():
        blases = blas_of_shape(boxes, joined.first[indices], joined.counts[indices], *shape)
        built.update(zip(indices, blases, strict=True))
    return [built[index] for index in range(len(meshes))]


def blas_of_shape(boxes: np.ndarray, first: np.ndarray, counts: np.ndarray, leaves: int, per_leaf: int) -> list[BLAS]:
    """M BVHs with `leaves` leaves each. `boxes` (2,3,N) in planes: `counts` (M,) for each BVH, from `first` (M,) on.

    Equal to those that blas_of_triangles builds.
    """
    mesh_count, count = len(first), counts[:, None]
    order = np.minimum(np.arange(leaves * per_leaf), count)
    unsorted = boxes.take(first[:, None] + np.minimum(order, count - 1), 2)
    centres = (unsorted[0] >> 1) + (unsorted[1] >> 1)
    order = sort(centres, order, 4 if per_leaf == 1 else per_leaf).reshape(mesh_count, -1)
    is_used = order < count
    leaf_boxes = boxes.take(first[:, None] + np.minimum(order, count - 1), 2)
    np.copyto(leaf_boxes, EMPTY_BOX[..., None], where=~is_used)
    nodes = node_boxes(leaf_boxes.reshape(2, 3, mesh_count, leaves, per_leaf))
    leaf_counts = is_used.reshape(mesh_count, leaves, per_leaf).sum(2)
    starts = np.minimum(np.cumsum(leaf_counts, 1) - leaf_counts, count - per_leaf).astype(np.uint32)
    ends = np.cumsum(counts).tolist()
    orders = np.split(order[is_used].astype(np.uint32), ends[:-1])
    by_mesh = zip(mesh_bounds(nodes), packed(nodes), starts, orders, strict=True)
    return [BLAS(bounds, rows, leaf_starts, per_leaf, order) for bounds, rows, leaf_starts, order in by_mesh]


def node_boxes(leaf_boxes: np.ndarray) -> np.ndarray:
    """(2,3,M,2 * leaves): BVH.nodes of M BVHs, whose leaves hold boxes (2,3,M,leaves,per_leaf)."""
    _, _, mesh_count, leaves, per_leaf = leaf_boxes.shape
    nodes = np.empty((2, 3, mesh_count, 2 * leaves), np.int16)
    nodes[..., 0] = EMPTY_BOX
    for corners, min_or_max, leaf_corners in zip(nodes, MIN_MAX, leaf_boxes, strict=True):
        corners[..., leaves:] = reduce(min_or_max, (leaf_corners[..., k] for k in range(per_leaf)))
        level = leaves
        while level > 1:
            children, level = corners[..., level : 2 * level], level // 2
            corners[..., level : 2 * level] = min_or_max(children[..., ::2], children[..., 1::2])
    return nodes


def packed(nodes: np.ndarray) -> np.ndarray:
    """(M,leaves // 2) BVH_NODE of nodes (2,3,M,2 * leaves), as bvh.packed of each."""
    mesh_count, leaves = nodes.shape[2], nodes.shape[3] // 2
    rows = np.zeros((mesh_count, leaves // 2), BVH_NODE)
    level = 1
    while level < leaves // 2:
        boxes, parents = nodes[..., 4 * level : 8 * level], nodes[..., level : 2 * level]
        level_rows = np.empty(mesh_count * level, BVH_NODE)
        pack(boxes.reshape(2, 3, -1), parents.reshape(2, 3, -1), level_rows)
        rows[:, level : 2 * level] = level_rows.reshape(mesh_count, level)
        level *= 4
    return rows


def mesh_bounds(nodes: np.ndarray) -> np.ndarray:
    """(M,P,2,3) BLAS.bounds of nodes (2,3,M,2 * leaves)."""
    level = min(BOXES_PER_MESH, nodes.shape[3] // 2)
    boxes = nodes[..., level : 2 * level].transpose(2, 3, 0, 1)
    is_used = boxes[:, :, 0, 0] <= boxes[:, :, 1, 0]
    indices = np.argsort(~is_used, axis=1, kind="stable")
    repeated = np.arange(level) % is_used.sum(1, keepdims=True)
    indices = np.take_along_axis(indices, repeated, 1)
    return np.take_along_axis(boxes, indices[:, :, None, None], 1) * np.float32(QUANTA_PER_PLANE)
