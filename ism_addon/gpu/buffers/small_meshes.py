# SPDX-License-Identifier: GPL-3.0-or-later
"""Joins small meshes, so that work on them costs time per triangle, not per mesh."""

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from ...scene import Mesh
from ..accel.quantization import quantizations, quantize

#: Maximum of triangles in a small mesh: work on one takes less time than calling numpy for it. See `dev.py bench
#: constants` in docs/benchmarks.md.
SMALL_MESH = 1 << 10

#: Maximum of triangles in joined meshes, so that they stay in the processor's cache.
TRIANGLES_AT_A_TIME = 1 << 14


class JoinedMeshes:
    """The arrays of several meshes, concatenated."""

    def __init__(self, meshes: Sequence[Mesh]):
        self.meshes = meshes
        self.vertex_counts = np.array([len(mesh.positions) for mesh in meshes], np.int64)
        self.counts = np.array([len(mesh.triangles) for mesh in meshes], np.int64)
        #: (M,): the first triangle of each mesh.
        self.first = np.cumsum(self.counts) - self.counts

    @cached_property
    def triangles(self) -> np.ndarray:
        """(T,3) uint32: indices of the joined vertices."""
        first = (np.cumsum(self.vertex_counts) - self.vertex_counts).astype(np.uint32)
        return np.concatenate([mesh.triangles for mesh in self.meshes]) + first.repeat(self.counts)[:, None]

    @cached_property
    def materials(self) -> np.ndarray:
        """(T,) uint32."""
        return np.concatenate([mesh.materials for mesh in self.meshes])

    @cached_property
    def uvs(self) -> np.ndarray:
        """(T,3,2), zero where a mesh has none."""
        uvs = np.zeros((int(self.counts.sum()), 3, 2), np.float32)
        has_uvs = np.array([len(mesh.uvs) > 0 for mesh in self.meshes], np.bool_)
        if has_uvs.any():
            uvs[has_uvs.repeat(self.counts)] = np.concatenate([mesh.uvs for mesh in self.meshes])
        return uvs

    @cached_property
    def attributes(self) -> np.ndarray:
        """(T,3,A,4), zero where a mesh has fewer."""
        count = max(mesh.attributes.shape[2] for mesh in self.meshes)
        attributes = np.zeros((int(self.counts.sum()), 3, count, 4), np.float32)
        for first, mesh in zip(self.first, self.meshes, strict=True):
            attributes[first : first + len(mesh.attributes), :, : mesh.attributes.shape[2]] = mesh.attributes
        return attributes

    @cached_property
    def normals(self) -> np.ndarray:
        """(T,3,3) for corners, or (V,3) for vertices if all meshes have normals for vertices."""
        is_by_vertex = np.array([mesh.normals.ndim == 2 for mesh in self.meshes], np.bool_)
        if is_by_vertex.all() or not is_by_vertex.any():
            return np.concatenate([mesh.normals for mesh in self.meshes])
        vertex_normals = np.zeros((int(self.vertex_counts.sum()), 3), np.float32)
        by_vertices = [mesh.normals for mesh in self.meshes if mesh.normals.ndim == 2]
        vertex_normals[is_by_vertex.repeat(self.vertex_counts)] = np.concatenate(by_vertices)
        corner_normals = vertex_normals[self.triangles]
        by_corners = [mesh.normals for mesh in self.meshes if mesh.normals.ndim == 3]
        corner_normals[~is_by_vertex.repeat(self.counts)] = np.concatenate(by_corners)
        return corner_normals

    def quantize(self, dtype: type) -> np.ndarray:
        """(3,V): the vertices, in the quanta of their meshes."""
        centres, quanta_per_metre = quantizations(self.meshes)
        positions = np.concatenate([mesh.positions for mesh in self.meshes])
        quanta = quantize(positions, centres.repeat(self.vertex_counts, 0), quanta_per_metre.repeat(self.vertex_counts))
        return quanta.astype(dtype)


def small_mesh_groups(counts: Sequence[int]) -> list[slice]:
    """Groups of consecutive meshes. `counts`: their triangles. Small meshes are grouped up to TRIANGLES_AT_A_TIME."""
    groups: list[slice] = []
    size = TRIANGLES_AT_A_TIME
    for index, count in enumerate(counts):
        if count > SMALL_MESH or size + count > TRIANGLES_AT_A_TIME:
            groups.append(slice(index, index + 1))
            size = count if count <= SMALL_MESH else TRIANGLES_AT_A_TIME
        else:
            groups[-1] = slice(groups[-1].start, index + 1)
            size += count
    return groups


def concatenated(arrays: Sequence[np.ndarray]) -> np.ndarray:
    """np.concatenate, which does not copy a single array."""
    return arrays[0] if len(arrays) == 1 else np.concatenate(arrays)
