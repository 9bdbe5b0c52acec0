# SPDX-License-Identifier: GPL-3.0-or-later
"""The bottom-level BVHs of all resident meshes, as arrays and on the GPU."""

from functools import cached_property

import numpy as np

from ...scene import Mesh
from ..buffers.small_meshes import concatenated, small_mesh_groups
from ..gl.context import Device
from .blas import BLAS, DeferredBLAS


class BLASTable:
    """The BVHs of the resident meshes, and the arrays that BuildTLAS needs of them, computed on first use."""

    def __init__(self, meshes: tuple[Mesh, ...], built: dict[int, BLAS | DeferredBLAS]):
        """`meshes` are all of the scene, `built` has BVHs by the index of their mesh."""
        self.meshes, self.built = meshes, built
        #: (M,): the row of a mesh of the scene in the arrays below; -1 for those that are not resident.
        self.rows = np.full(len(meshes), -1)
        self.rows[list(built)] = np.arange(len(built))

    @cached_property
    def trees(self) -> tuple[BLAS, ...]:
        """One a resident mesh."""
        return tuple(each.blas for each in self.built.values())

    @cached_property
    def boxes(self) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Bounds of the resident meshes, grouped by how many boxes P a mesh has.

        Of each group: (W,) the row of a resident mesh in it, -1 for others; centres and half sizes (3,N,P) of the
        boxes.
        """
        counts, found = np.array([len(tree.bounds) for tree in self.trees], np.int64), []
        for count in np.unique(counts).tolist():
            own = np.flatnonzero(counts == count)
            rows = np.full(len(counts), -1)
            rows[own] = np.arange(len(own))
            bounds = np.concatenate([self.trees[number].bounds for number in own]).astype(np.float64)
            low, high = bounds.reshape(-1, count, 2, 3).transpose(2, 3, 0, 1)
            found.append((rows, (low + high) / 2.0, (high - low) / 2.0))
        return found

    @cached_property
    def leaves(self) -> np.ndarray:
        """(W,) int64: their number."""
        return np.array([tree.leaves for tree in self.trees], np.int64)

    @cached_property
    def triangles_per_leaf(self) -> np.ndarray:
        """(W,) int64."""
        return np.array([tree.triangles_per_leaf for tree in self.trees], np.int64)


class BLASBuffers:
    """BVHs of meshes, concatenated."""

    def __init__(self, device: Device, trees: tuple[BLAS, ...]):
        self.first_nodes = np.cumsum([0] + [len(tree.nodes) for tree in trees])
        self.first_leaves = np.cumsum([0] + [tree.leaves for tree in trees])
        self.nodes = device.new_buffer(2 * int(self.first_nodes[-1]), 4, "u4")
        self.leaf_starts = device.new_buffer(int(self.first_leaves[-1]), 1, "u4")
        for group in small_mesh_groups([tree.leaves for tree in trees]):  # those of small meshes in one write
            grouped, first = trees[group], group.start
            self.nodes.write(concatenated([rows_of(tree.nodes) for tree in grouped]), 2 * int(self.first_nodes[first]))
            self.leaf_starts.write(concatenated([tree.leaf_starts for tree in grouped]), int(self.first_leaves[first]))
        self.bytes = sum(tree.leaf_starts.nbytes + tree.nodes.nbytes for tree in trees)


def rows_of(nodes: np.ndarray) -> np.ndarray:
    """(2 N,4) uint32: BVH_NODEs (N,) as texels."""
    return nodes.view(np.uint32).reshape(-1, 4)
