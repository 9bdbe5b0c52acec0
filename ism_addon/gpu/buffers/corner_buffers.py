# SPDX-License-Identifier: GPL-3.0-or-later
"""Texture coordinates and other attributes of corners on the GPU, for resident meshes, in the order of triangles."""

import math
from typing import Any

import numpy as np

from ..gl.buffer_texture import BufferTexture
from ..gl.context import Device
from .mesh_buffers import MeshBuffers, TriangleRange


class CornerBuffers:
    """An array of the resident meshes, by triangle and corner; zero for meshes without it."""

    def __init__(self, device: Device, mesh_buffers: MeshBuffers, name: str, shape: tuple[int, ...]):
        """`name`: of a field of Mesh. `shape`: what a triangle has of it; its last dimension is a row."""
        self.mesh_buffers, self.mesh_count, self.bytes = mesh_buffers, 0, 0
        self.name, self.shape = name, shape
        self._rows = device.growing_buffer(shape[-1], "f4")

    @property
    def texture(self) -> BufferTexture:
        """The buffer."""
        return self._rows.texture

    def upload_new(self) -> int:
        """Upload those of meshes that have become resident. Returns the number of bytes."""
        order = self.mesh_buffers.order(list(self.mesh_buffers.blases)[self.mesh_count :])
        rows = order.count * math.prod(self.shape[:-1])
        self._rows.count = self.bytes // self.texture.row  # overwrites an upload that failed
        self._rows.reserve(rows)
        for portion in order.map_portions(lambda ranges: rows_of(ranges, self.name, self.shape), with_vertices=False):
            self._rows.append(portion)
        self.mesh_count += len(order.meshes)
        self.bytes += rows * self.texture.row
        return rows * self.texture.row


class UVBuffers(CornerBuffers):
    """Texture coordinates: a row a corner."""

    def __init__(self, device: Device, mesh_buffers: MeshBuffers):
        super().__init__(device, mesh_buffers, "uvs", (3, 2))


class AttributeBuffers(CornerBuffers):
    """What else graphs read: as many rows a corner as the mesh that has most."""

    def __init__(self, device: Device, mesh_buffers: MeshBuffers):
        self.count = max((mesh.attributes.shape[2] for mesh in mesh_buffers.meshes), default=0)
        super().__init__(device, mesh_buffers, "attributes", (3, self.count, 4))


def attribute_uniforms(buffers: AttributeBuffers) -> dict[str, Any]:
    """Uniforms of nodes/point.glsl."""
    return {"attributes": buffers.texture, "attribute_count": buffers.count}


def rows_of(ranges: list[TriangleRange], name: str, shape: tuple[int, ...]) -> np.ndarray:
    """(R,components) float32: rows of an array of triangles (N,*shape), padded with zeros."""
    chunks = []
    for range_ in ranges:
        stored: np.ndarray = getattr(range_.source.arrays, name)
        chunk = np.zeros((len(range_.triangles), *shape), np.float32)
        if len(stored):
            rows = stored[range_.indices]
            chunk[tuple(slice(size) for size in rows.shape)] = rows
        chunks.append(chunk)
    return np.concatenate(chunks).reshape(-1, shape[-1])
