# SPDX-License-Identifier: GPL-3.0-or-later
"""Acceleration structures for rays: a BVH over each mesh's triangles, and one over instances that cast shadows.

There are two levels, so that a mesh keeps its BVH when its instances move.
"""

from typing import ClassVar
from weakref import WeakKeyDictionary

import numpy as np

from ....resources import BLAS, BLAS_BUFFERS, INSTANCE_BUFFERS, MESH_BUFFERS, RESIDENT_MESHES, TLAS
from ....scene import Change, Mesh
from ...accel import blas
from ...accel.blas_table import NODE_TEXELS, BLASBuffers, BLASTable, node_texels
from ...accel.bvh import EMPTY_BOX, build, packed
from ...accel.small_blas import build_all_blas
from ...accel.tlas import instance_bounds, inverse_of, on_grid
from ...buffers.instance_buffers import anchor_from_quanta
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.shader_records import CASTER
from ...occlusion import traces_rays


class BuildBLAS(Pass):
    """A BVH for each resident mesh, finished or being built; an unchanged mesh keeps its BVH."""

    schedule = Schedule.FIRST
    inputs = Change.MESHES, RESIDENT_MESHES
    outputs = outputs(BLAS)

    #: The BVHs of all meshes that exist, shared by all renderers.
    cache: ClassVar[WeakKeyDictionary[Mesh, blas.BLAS | blas.DeferredBLAS]] = WeakKeyDictionary()

    def needed(self, frame: Frame) -> bool:
        """Also without rays, if a BVH has already sorted the triangles: they keep the order of its leaves."""
        previous = frame.get(BLAS)
        return traces_rays(frame) or (previous is not None and previous.meshes == frame.scene.meshes)

    def execute(self, frame: Frame) -> None:
        meshes = frame.scene.meshes
        resident = {index: meshes[index] for index in frame[RESIDENT_MESHES].indices}
        new = [mesh for mesh in resident.values() if mesh not in self.cache]
        self.cache.update(zip(new, build_all_blas(new), strict=True))
        frame[BLAS] = BLASTable(meshes, {index: self.cache[mesh] for index, mesh in resident.items()})


class UploadBLAS(Pass):
    """Upload the BVHs of the resident meshes, when all are finished."""

    schedule = Schedule.FIRST
    inputs = (BLAS,)
    outputs = outputs(BLAS_BUFFERS)

    def needed(self, frame: Frame) -> bool:
        return traces_rays(frame)

    def execute(self, frame: Frame) -> None:
        buffers = BLASBuffers(self.device, frame[BLAS].blases)
        frame.counts["bytes_uploaded"] += buffers.bytes
        frame[BLAS_BUFFERS] = buffers


class BuildTLAS(Pass):
    """Build the BVH over the instances that cast shadows; moving an instance uploads no mesh."""

    schedule = Schedule.FIRST
    inputs = BLAS, BLAS_BUFFERS, MESH_BUFFERS, INSTANCE_BUFFERS, Change.INSTANCES
    outputs = outputs(TLAS)

    def needed(self, frame: Frame) -> bool:
        return traces_rays(frame)

    def execute(self, frame: Frame) -> None:
        table, buffers, instances = frame[BLAS], frame[BLAS_BUFFERS], frame.scene.instances
        indices = np.flatnonzero(instances.casts_shadow & (table.rows[instances.mesh] >= 0))
        mesh = instances.mesh[indices]
        row, meshes = table.rows[mesh], frame[MESH_BUFFERS]
        linear, offsets = anchor_from_quanta(meshes, instances, indices, frame.anchor)
        low, high = (np.empty((len(indices), 3), np.float32) for _ in range(2))
        for group_rows, centres, half_sizes in table.boxes:
            members = np.flatnonzero(group_rows[row] >= 0)
            boxes_of = group_rows[row[members]]
            low[members], high[members] = instance_bounds(
                linear[members], offsets[members], boxes_of, centres, half_sizes
            )
        centre, scale, boxes = on_grid(low, high) if len(indices) else (np.zeros(3), np.ones(3), EMPTY_BOX)
        bvh = build(boxes, 1)
        nodes = node_texels(packed(bvh.nodes))
        casters = np.zeros(len(indices), CASTER.dtype)
        inverse = inverse_of(linear, offsets)
        for k in range(3):
            casters[f"row{k}"] = inverse[:, k]
        casters["first_node"] = buffers.first_nodes[row]
        casters["first_leaf"] = buffers.first_leaves[row]
        casters["leaves"] = table.leaves[row]
        casters["triangles_per_leaf"] = table.triangles_per_leaf[row]
        casters["first_triangle"] = meshes.first_triangle[mesh]
        casters["instance"] = frame[INSTANCE_BUFFERS].rows[indices]
        casters["link_groups"] = instances.groups[indices]
        frame[TLAS] = {
            "blas_nodes": buffers.nodes,
            "corners": meshes.samplers["corners"],
            "tlas_nodes": frame.scene_records.write("tlas_nodes", nodes, NODE_TEXELS),
            "casters": CASTER.write(
                frame.scene_records, "casters", np.append(casters, np.zeros(1, CASTER.dtype))[bvh.order]
            ),
            "tlas_leaves": bvh.leaves,
            "tlas_centre": tuple(centre),
            "tlas_scale": tuple(scale),
        }
        frame.counts["bytes_uploaded"] += casters.nbytes + nodes.nbytes
