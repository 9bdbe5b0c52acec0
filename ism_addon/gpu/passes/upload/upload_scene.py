# SPDX-License-Identifier: GPL-3.0-or-later
"""Upload meshes, instances and materials, each when it has changed."""

from ....resources import (
    ATTRIBUTE_BUFFERS,
    BLAS,
    INSTANCE_BUFFERS,
    MATERIAL_BUFFERS,
    MESH_BUFFERS,
    RESIDENT_MESHES,
    UV_BUFFERS,
)
from ....scene import Change
from ...buffers.corner_buffers import AttributeBuffers, UVBuffers
from ...buffers.instance_buffers import InstanceBuffers, Owners
from ...buffers.material_buffers import MaterialBuffers
from ...buffers.mesh_buffers import MeshBuffers
from ...buffers.texture_buffer import TextureBuffer
from ...frame import Frame, Pass, Schedule, outputs


class UploadMeshes(Pass):
    """Upload vertices and triangles of the resident meshes, in the order of BVH leaves once rays are traced."""

    schedule = Schedule.FIRST
    inputs = Change.MESHES, RESIDENT_MESHES, BLAS
    outputs = outputs(MESH_BUFFERS)

    def execute(self, frame: Frame) -> None:
        blas = frame.get(BLAS)
        built = blas.built if blas is not None and blas.meshes == frame.scene.meshes else None
        buffers = frame.shared_resource(MeshBuffers, frame.scene.meshes, built is not None)
        frame.counts["bytes_uploaded"] += buffers.add(frame[RESIDENT_MESHES].indices, built or {})
        frame[MESH_BUFFERS] = buffers


class UploadUVs(Pass):
    """Upload texture coordinates of the resident meshes."""

    schedule = Schedule.FIRST
    inputs = (MESH_BUFFERS,)
    outputs = outputs(UV_BUFFERS)

    def needed(self, frame: Frame) -> bool:
        scene = frame.scene
        return bool((scene.materials.image >= 0).any()) or any(graph.uses("uv_map") for graph in scene.graphs)

    def execute(self, frame: Frame) -> None:
        buffers = frame.shared_resource(UVBuffers, frame[MESH_BUFFERS])
        frame.counts["bytes_uploaded"] += buffers.upload_new()
        frame[UV_BUFFERS] = buffers


class UploadAttributes(Pass):
    """Upload what graphs read of the resident meshes besides texture coordinates."""

    schedule = Schedule.FIRST
    inputs = (MESH_BUFFERS,)
    outputs = outputs(ATTRIBUTE_BUFFERS)

    def needed(self, frame: Frame) -> bool:
        return any(graph.uses("mesh_attribute") for graph in frame.scene.graphs)

    def execute(self, frame: Frame) -> None:
        buffers = frame.shared_resource(AttributeBuffers, frame[MESH_BUFFERS])
        frame.counts["bytes_uploaded"] += buffers.upload_new()
        frame[ATTRIBUTE_BUFFERS] = buffers


class UploadInstances(Pass):
    """Upload matrices and link groups of the instances."""

    schedule = Schedule.FIRST
    inputs = Change.INSTANCES, MESH_BUFFERS
    outputs = outputs(INSTANCE_BUFFERS)

    def execute(self, frame: Frame) -> None:
        meshes = frame[MESH_BUFFERS]
        buffers = InstanceBuffers(self.device, frame.scene_records, meshes, frame.scene.instances, frame.anchor)
        buffers.set_owners(lambda pairs: frame.shared_resource(Owners, meshes, pairs))
        frame[INSTANCE_BUFFERS] = buffers
        frame.counts["bytes_uploaded"] += buffers.bytes


class UploadMaterials(Pass):
    """Upload materials and images."""

    schedule = Schedule.FIRST
    inputs = (Change.MATERIALS,)
    outputs = outputs(MATERIAL_BUFFERS)

    def execute(self, frame: Frame) -> None:
        texels = frame.shared_resource(TextureBuffer, frame.scene.images)
        scene = frame.scene
        frame[MATERIAL_BUFFERS] = frame.shared_resource(MaterialBuffers, scene.materials, scene.graphs, texels)
