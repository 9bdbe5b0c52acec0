# SPDX-License-Identifier: GPL-3.0-or-later
"""The instances on the GPU, and their draw calls."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from ...scene import Instances
from ..culling.frustum_culling import in_view, runs
from ..gl.buffer_texture import SceneRecords
from ..gl.context import Device
from ..gl.shader_records import INSTANCE, MEMBERSHIP, OBJECT_INFO
from .mesh_buffers import MeshBuffers
from .small_meshes import SMALL_MESH

#: Small meshes are drawn together if Owners has at most this many rows per triangle of them. Otherwise the small meshes
#: are so few that their draw calls do not matter. See `dev.py bench constants` in docs/benchmarks.md.
MAX_OWNERS_RATIO = 16


@dataclass(frozen=True)
class DrawCall:
    """Instances of one mesh: one draw call."""

    first_triangle: int
    triangles: int
    first_instance: int
    instances: int


@dataclass(frozen=True)
class MultiDrawCall:
    """Small meshes of one instance each, drawn together. Shaders read the instance of a triangle from Owners."""

    first_triangle: np.ndarray  # (R,) int64
    triangles: np.ndarray  # (R,) int64


class Owners:
    """A table on the GPU: the instance of each triangle, for small meshes of one instance."""

    def __init__(self, device: Device, mesh_buffers: MeshBuffers, pairs: bytes):
        """`pairs` (N,2) int64: the index of a mesh, and the row of its instance."""
        meshes, rows = np.frombuffer(pairs, np.int64).reshape(-1, 2).T
        first, counts = mesh_buffers.first_triangle[meshes], mesh_buffers.counts[meshes]
        owners = np.zeros((int((first + counts).max(initial=0)), 1), np.uint32)
        index_in_mesh = np.arange(counts.sum()) - (np.cumsum(counts) - counts).repeat(counts)
        owners[first.repeat(counts) + index_in_mesh, 0] = rows.repeat(counts)
        self.texture = device.buffer_from(owners)
        self.bytes = owners.nbytes


class InstanceBuffers:
    """Transforms and link groups of visible instances, sorted by mesh."""

    def __init__(
        self,
        device: Device,
        records: SceneRecords,
        mesh_buffers: MeshBuffers,
        instances: Instances,
        anchor: np.ndarray,
    ):
        visible = np.flatnonzero(instances.visible)
        order = visible[np.argsort(instances.mesh[visible], kind="stable")]
        #: The row of each instance of the scene; -1 if it is not visible.
        self.rows = np.full(len(instances.mesh), -1)
        self.rows[order] = np.arange(len(order))
        mesh = instances.mesh[order]
        linear, offsets = anchor_from_quanta(mesh_buffers, instances, order, anchor)
        self.matrices = np.concatenate([linear, offsets[:, :, None]], 2)
        #: Rows of INSTANCE, and of OBJECT_INFO if graphs read it.
        self.transforms = instance_table(linear, offsets)
        self.table = INSTANCE.upload(device, self.transforms)
        groups = np.zeros(len(order), MEMBERSHIP.dtype)
        groups["groups"] = instances.groups[order]
        self.memberships = MEMBERSHIP.write(records, "link_groups", groups)
        self.object_info = object_info(mesh_buffers, instances, order if len(instances.color) else order[:0])
        self.info = OBJECT_INFO.upload(device, self.object_info) if len(instances.color) else None
        #: Uniforms of nodes/instance_attributes.glsl.
        self.attributes = attribute_uniforms(records, "instance_attributes", instances, order)
        self.bytes = self.transforms.nbytes + groups.nbytes
        self.mesh_buffers = mesh_buffers
        #: The mesh of each row, -1 if it is not resident.
        self.mesh = np.where(mesh_buffers.first_triangle[mesh] >= 0, mesh, -1)
        has_one_instance = np.bincount(mesh, minlength=len(mesh_buffers.meshes))[mesh] == 1
        #: Whether each row is drawn by a MultiDrawCall.
        self.is_single = (self.mesh >= 0) & has_one_instance & (mesh_buffers.counts[mesh] <= SMALL_MESH)
        singles = self.mesh[self.is_single]
        ends = mesh_buffers.first_triangle[singles] + mesh_buffers.counts[singles]
        if len(singles) < 2 or ends.max() > MAX_OWNERS_RATIO * mesh_buffers.counts[singles].sum():
            self.is_single[:] = False
        self.half_sizes = mesh_buffers.half_sizes[mesh]

    def set_owners(self, share: Callable[[bytes], Owners]) -> None:
        """Set the table for MultiDrawCall. `share` makes Owners, or returns equal ones of another renderer."""
        rows = np.flatnonzero(self.is_single)
        self.owners = share(np.stack([self.mesh[rows], rows], 1).astype(np.int64).tobytes())

    def in_view(self, clip_from_anchor: np.ndarray, margin: float) -> np.ndarray:
        """(I,) bool: the rows that may be in view; `margin` as in frustum_culling.in_view."""
        clip_from_centre = clip_from_anchor[:, :3] @ self.matrices
        clip_from_centre[..., 3] += clip_from_anchor[:, 3]
        return in_view(self.half_sizes, clip_from_centre, margin)

    def with_materials(self, chosen: np.ndarray) -> np.ndarray:
        """(I,) bool: the rows whose meshes have any of the chosen materials (M,) bool."""
        of_meshes = [bool(chosen[mesh.material_indices].any()) for mesh in self.mesh_buffers.meshes]
        return (self.mesh >= 0) & np.array(of_meshes, np.bool_)[self.mesh]

    def draw_calls(self, is_drawn: np.ndarray) -> Iterator[DrawCall | MultiDrawCall]:
        """Draw calls of the rows where `is_drawn` (I,) is true."""
        first_rows_and_counts = runs(is_drawn, self.mesh)
        rows, instances = np.array(first_rows_and_counts, np.int64).reshape(-1, 2).T
        meshes = self.mesh[rows]
        first, counts = self.mesh_buffers.first_triangle[meshes], self.mesh_buffers.counts[meshes]
        is_single = self.is_single[rows]
        edges = np.flatnonzero(np.diff(is_single, prepend=False, append=False))
        begin = 0
        for edge, end in [*edges.reshape(-1, 2).tolist(), [len(rows), len(rows)]]:
            for k in range(begin, edge):
                yield DrawCall(int(first[k]), int(counts[k]), int(rows[k]), int(instances[k]))
            if edge < end:
                yield MultiDrawCall(first[edge:end], counts[edge:end])
            begin = end


def portions(draws: Iterator[DrawCall | MultiDrawCall], max_triangles: int) -> Iterator[DrawCall | MultiDrawCall]:
    """Split draw calls so that each draws at most about `max_triangles` triangles, or one triangle per instance."""
    for draw in draws:
        if isinstance(draw, MultiDrawCall):
            portion_index = np.cumsum(draw.triangles) // max_triangles
            ends = [*(np.flatnonzero(np.diff(portion_index)) + 1).tolist(), len(portion_index)]
            for first, end in pairwise([0, *ends]):
                yield joined_ranges(draw.first_triangle[first:end], draw.triangles[first:end])
            continue
        size = max(max_triangles // draw.instances, 1)
        for first in range(0, draw.triangles, size):
            count = min(size, draw.triangles - first)
            yield replace(draw, first_triangle=draw.first_triangle + first, triangles=count)


def joined_ranges(first: np.ndarray, triangles: np.ndarray) -> MultiDrawCall:
    """Ranges of `triangles` triangles from `first` on; adjacent ranges are joined."""
    begins = np.flatnonzero(np.append(True, first[1:] != (first + triangles)[:-1]))
    return MultiDrawCall(first[begins], np.add.reduceat(triangles, begins))


def instance_table(linear: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """(N,) rows of INSTANCE, of transforms (N,3,3) and (N,3)."""
    table = np.zeros(len(linear), INSTANCE.dtype)
    for k in range(3):
        table[f"row{k}"] = np.concatenate([linear[:, k], offsets[:, k, None]], 1)
    return table


def object_info(mesh_buffers: MeshBuffers, instances: Instances, rows: np.ndarray) -> np.ndarray:
    """(N,) rows of OBJECT_INFO for instances (N,)."""
    info = np.zeros(len(rows), OBJECT_INFO.dtype)
    mesh = instances.mesh[rows]
    info["centre"], info["metres_per_quantum"] = mesh_buffers.centres[mesh], 1.0 / mesh_buffers.quanta_per_metre[mesh]
    info["location"] = instances.world_from_object[rows, :3, 3]
    info["color"], info["index"] = instances.color[rows], instances.pass_index[rows]
    info["random"] = instances.random[rows]
    return info


def attribute_uniforms(records: SceneRecords, table: str, instances: Instances, rows: np.ndarray) -> dict[str, Any]:
    """Uniforms of nodes/instance_attributes.glsl for instances (N,), whose table is written; none without any."""
    count = instances.attributes.shape[1]
    if not count:
        return {}
    words = np.ascontiguousarray(instances.attributes[rows]).view(np.uint32).reshape(-1, 4)
    return {"instance_attributes": records.write(table, words, 1), "instance_attribute_count": count}


def anchor_from_quanta(
    mesh_buffers: MeshBuffers, instances: Instances, rows: np.ndarray, anchor: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Transforms (N,3,3) and (N,3) float64 of instances (N,) from the quanta of their meshes to anchor space."""
    mesh, matrices = instances.mesh[rows], instances.world_from_object[rows]
    linear = matrices[:, :3, :3]
    offsets = np.einsum("nij,nj->ni", linear, mesh_buffers.centres[mesh]) + matrices[:, :3, 3] - anchor
    return linear / mesh_buffers.quanta_per_metre[mesh, None, None], offsets
