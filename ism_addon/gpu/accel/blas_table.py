# SPDX-License-Identifier: GPL-3.0-or-later
"""The bottom-level BVHs of all resident meshes, as arrays and on the GPU."""

from functools import cached_property

import numpy as np

from ...scene import Mesh
from ..buffers.small_meshes import concatenated, small_mesh_groups
from ..gl.context import Device
from ..gl.shader_records import TEXEL_WORDS
from .blas import BLAS, DeferredBLAS

#: Texels of a node.
NODE_TEXELS = 2


class BLASTable:
    """The BVHs of the W resident meshes, and arrays of their properties for BuildTLAS, computed on first use."""

    def __init__(self, meshes: tuple[Mesh, ...], built: dict[int, BLAS | DeferredBLAS]):
        """`meshes` are all meshes of the scene, `built` has BVHs by the index of their mesh."""
        self.meshes, self.built = meshes, built
        #: (M,): the row of each mesh of the scene in the arrays below; -1 if it is not resident.
        self.rows = np.full(len(meshes), -1)
        self.rows[list(built)] = np.arange(len(built))

    @cached_property
    def blases(self) -> tuple[BLAS, ...]:
        """The BVH of each resident mesh; waits until all are built."""
        return tuple(each.blas for each in self.built.values())

    @cached_property
    def boxes(self) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Bounds of the resident meshes, grouped by how many boxes P a mesh has.

        For each group of N meshes: (W,) the row of each resident mesh in it, -1 for others; centres and half sizes
        (3,N,P) of the boxes.
        """
        counts, groups = np.array([len(blas.bounds) for blas in self.blases], np.int64), []
        for count in np.unique(counts).tolist():
            in_group = np.flatnonzero(counts == count)
            rows = np.full(len(counts), -1)
            rows[in_group] = np.arange(len(in_group))
            bounds = np.concatenate([self.blases[row].bounds for row in in_group]).astype(np.float64)
            low, high = bounds.reshape(-1, count, 2, 3).transpose(2, 3, 0, 1)
            groups.append((rows, (low + high) / 2.0, (high - low) / 2.0))
        return groups

    @cached_property
    def leaves(self) -> np.ndarray:
        """(W,) int64: number of leaves."""
        return np.array([blas.leaves for blas in self.blases], np.int64)

    @cached_property
    def triangles_per_leaf(self) -> np.ndarray:
        """(W,) int64."""
        return np.array([blas.triangles_per_leaf for blas in self.blases], np.int64)


class BLASBuffers:
    """BVHs of meshes on the GPU in one buffer texture: the nodes of all, then the leaf starts of all, four a texel."""

    def __init__(self, device: Device, blases: tuple[BLAS, ...]):
        #: For each BVH, and at the end the total.
        self.first_nodes = np.cumsum([0] + [len(blas.nodes) for blas in blases])
        end_of_nodes = TEXEL_WORDS * NODE_TEXELS * int(self.first_nodes[-1])
        #: For each BVH, and at the end of all: its first leaf start, as an index of the buffer's words.
        self.first_leaves = np.cumsum([end_of_nodes] + [blas.leaves for blas in blases])
        self.nodes = device.new_buffer(-(-int(self.first_leaves[-1]) // TEXEL_WORDS), TEXEL_WORDS, "u4")
        for group in small_mesh_groups([blas.leaves for blas in blases]):  # BVHs of small meshes are written together
            grouped, first = blases[group], group.start
            nodes = concatenated([node_texels(blas.nodes) for blas in grouped])
            self.nodes.write(nodes, NODE_TEXELS * int(self.first_nodes[first]))
            leaf_starts = concatenated([blas.leaf_starts for blas in grouped])
            self.nodes.buffer.write(leaf_starts, offset=leaf_starts.itemsize * int(self.first_leaves[first]))
        self.bytes = sum(blas.leaf_starts.nbytes + blas.nodes.nbytes for blas in blases)


def node_texels(nodes: np.ndarray) -> np.ndarray:
    """(N * NODE_TEXELS,4) uint32 texels of nodes (N,) BVH_NODE."""
    return nodes.view(np.uint32).reshape(-1, 4)
