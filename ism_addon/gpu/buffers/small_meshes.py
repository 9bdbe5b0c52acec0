# SPDX-License-Identifier: GPL-3.0-or-later
"""Small meshes as one: what is done once for all of them costs by triangle, not by mesh."""

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from ...scene import Mesh
from ..accel.quantization import quantizations, quantize

#: Meshes of at most so many triangles are small: what numpy does to one by itself takes longer to begin than to do.
SMALL_MESH = 1 << 10

#: Triangles of all meshes that are put together, at most: so many stay in a processor's cache.
TRIANGLES_AT_A_TIME = 1 << 14


class JoinedMeshes:
    """The arrays of some meshes, one mesh behind the other."""

    def __init__(self, meshes: Sequence[Mesh]):
        self.meshes = meshes
        self.vertices = np.array([len(mesh.positions) for mesh in meshes], np.int64)
        self.counts = np.array([len(mesh.triangles) for mesh in meshes], np.int64)
        #: (M,): where the triangles of each begin.
        self.first = np.cumsum(self.counts) - self.counts

    @cached_property
    def triangles(self) -> np.ndarray:
        """(T,3) uint32, into the vertices of all."""
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
        """(T,3,3) of the corners, or (V,3) where all meshes have them by vertex."""
        by_vertex = np.array([mesh.normals.ndim == 2 for mesh in self.meshes], np.bool_)
        if by_vertex.all() or not by_vertex.any():
            return np.concatenate([mesh.normals for mesh in self.meshes])
        of_vertices = np.zeros((int(self.vertices.sum()), 3), np.float32)
        those = [mesh.normals for mesh in self.meshes if mesh.normals.ndim == 2]
        of_vertices[by_vertex.repeat(self.vertices)] = np.concatenate(those)
        found = of_vertices[self.triangles]
        others = [mesh.normals for mesh in self.meshes if mesh.normals.ndim == 3]
        found[~by_vertex.repeat(self.counts)] = np.concatenate(others)
        return found

    def quantize(self, dtype: type) -> np.ndarray:
        """(3,V) whole numbers: all vertices in the quanta of their meshes."""
        centres, quanta_per_metre = quantizations(self.meshes)
        positions = np.concatenate([mesh.positions for mesh in self.meshes])
        found = quantize(positions, centres.repeat(self.vertices, 0), quanta_per_metre.repeat(self.vertices))
        return found.astype(dtype)


def small_mesh_groups(counts: Sequence[int]) -> list[slice]:
    """Meshes of so many triangles in groups of neighbours: up to TRIANGLES_AT_A_TIME of small ones, any other alone."""
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
    """Arrays one behind the other; a single one, which may be large, is not copied."""
    return arrays[0] if len(arrays) == 1 else np.concatenate(arrays)
