# SPDX-License-Identifier: GPL-3.0-or-later
"""Joins small meshes, so that work on them takes time by triangle, not by mesh."""

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from ...scene import Mesh
from ..accel.quantization import quantizations, quantize

#: Most triangles of a small mesh: work on one takes less time than calling numpy for it. See `dev.py bench constants`
#: in docs/benchmarks.md.
SMALL_MESH = 1 << 10

#: Most triangles of joined meshes, so that they stay in the processor's cache.
TRIANGLES_AT_A_TIME = 1 << 14


class JoinedMeshes:
    """The arrays of several meshes, concatenated."""

    def __init__(self, meshes: Sequence[Mesh]):
        self.meshes = meshes
        self.vertices = np.array([len(mesh.positions) for mesh in meshes], np.int64)
        self.counts = np.array([len(mesh.triangles) for mesh in meshes], np.int64)
        #: (M,): the first triangle of each.
        self.first = np.cumsum(self.counts) - self.counts

    @cached_property
    def triangles(self) -> np.ndarray:
        """(T,3) uint32, indices of the joined vertices."""
        first = (np.cumsum(self.vertices) - self.vertices).astype(np.uint32)
        return np.concatenate([mesh.triangles for mesh in self.meshes]) + first.repeat(self.counts)[:, None]

    @cached_property
    def materials(self) -> np.ndarray:
        """(T,) uint32."""
        return np.concatenate([mesh.materials for mesh in self.meshes])

    @cached_property
    def uvs(self) -> np.ndarray:
        """(T,3,2), zero where a mesh has none."""
        found = np.zeros((int(self.counts.sum()), 3, 2), np.float32)
        having = np.array([len(mesh.uvs) > 0 for mesh in self.meshes], np.bool_)
        if having.any():
            found[having.repeat(self.counts)] = np.concatenate([mesh.uvs for mesh in self.meshes])
        return found

    @cached_property
    def normals(self) -> np.ndarray:
        """(T,3,3) of corners, or (V,3) of vertices if all meshes have the latter."""
        by_vertex = np.array([mesh.normals.ndim == 2 for mesh in self.meshes], np.bool_)
        if by_vertex.all() or not by_vertex.any():
            return np.concatenate([mesh.normals for mesh in self.meshes])
        of_vertices = np.zeros((int(self.vertices.sum()), 3), np.float32)
        by_vertices = [mesh.normals for mesh in self.meshes if mesh.normals.ndim == 2]
        of_vertices[by_vertex.repeat(self.vertices)] = np.concatenate(by_vertices)
        of_corners = of_vertices[self.triangles]
        by_corners = [mesh.normals for mesh in self.meshes if mesh.normals.ndim == 3]
        of_corners[~by_vertex.repeat(self.counts)] = np.concatenate(by_corners)
        return of_corners

    def quantize(self, dtype: type) -> np.ndarray:
        """(3,V): the vertices in quanta of their own meshes."""
        centres, quanta_per_metre = quantizations(self.meshes)
        positions = np.concatenate([mesh.positions for mesh in self.meshes])
        found = quantize(positions, centres.repeat(self.vertices, 0), quanta_per_metre.repeat(self.vertices))
        return found.astype(dtype)


def small_mesh_groups(counts: Sequence[int]) -> list[slice]:
    """Group consecutive meshes of so many triangles: small ones up to TRIANGLES_AT_A_TIME, others alone."""
    groups: list[slice] = []
    size = TRIANGLES_AT_A_TIME
    for number, count in enumerate(counts):
        if count > SMALL_MESH or size + count > TRIANGLES_AT_A_TIME:
            groups.append(slice(number, number + 1))
            size = count if count <= SMALL_MESH else TRIANGLES_AT_A_TIME
        else:
            groups[-1] = slice(groups[-1].start, number + 1)
            size += count
    return groups


def concatenated(arrays: Sequence[np.ndarray]) -> np.ndarray:
    """np.concatenate, which does not copy a single array."""
    return arrays[0] if len(arrays) == 1 else np.concatenate(arrays)
