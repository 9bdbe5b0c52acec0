# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's arrays to the GPU: meshes, where they stand, what they are made of. Each when it is new."""

from ....scene import Change
from ...accel.blas import BLAS, DeferredBLAS
from ...buffers.instance_buffers import InstanceBuffers, Owners
from ...buffers.material_buffers import MaterialBuffers, TextureBuffer
from ...buffers.mesh_buffers import MeshBuffers, UVBuffers
from ...frame import Frame, Pass


def blas_of(frame: Frame) -> dict[int, BLAS | DeferredBLAS] | None:
    """Those of the wanted meshes, or None where rays have never asked for them."""
    table = frame.tables.get("mesh_trees")
    return table.made if table is not None and table.meshes == frame.scene.meshes else None


class UploadMeshes(Pass):
    """Vertices and triangles of the wanted meshes."""

    reads = ("mesh_trees",)
    compares = ("wanted",)
    makes = ("geometry",)
    depends_on = (Change.MESHES,)

    def draw(self, frame: Frame) -> None:
        trees = blas_of(frame)
        geometry = frame.shared(MeshBuffers, frame.scene.meshes, trees is not None)
        frame.counts["bytes_uploaded"] += geometry.add(frame.tables["wanted"], trees or {})
        frame.tables["geometry"] = geometry


class UploadUVs(Pass):
    """Texture coordinates of the wanted meshes."""

    reads = ("geometry",)
    makes = ("coordinates",)

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.images) > 0

    def draw(self, frame: Frame) -> None:
        coordinates = frame.shared(UVBuffers, frame.tables["geometry"])
        frame.counts["bytes_uploaded"] += coordinates.follow()
        frame.tables["coordinates"] = coordinates


class UploadInstances(Pass):
    """The matrices of the instances."""

    reads = ("geometry",)
    makes = ("placement",)
    depends_on = (Change.INSTANCES,)

    def draw(self, frame: Frame) -> None:
        geometry = frame.tables["geometry"]
        placement = InstanceBuffers(self.device, geometry, frame.scene.instances, frame.anchor)
        placement.own(lambda pairs: frame.shared(Owners, geometry, pairs))
        frame.tables["placement"] = placement
        frame.counts["bytes_uploaded"] += placement.bytes


class UploadMaterials(Pass):
    """Materials and images."""

    makes = ("surfaces",)
    depends_on = (Change.MATERIALS,)

    def draw(self, frame: Frame) -> None:
        texels = frame.shared(TextureBuffer, frame.scene.images)
        frame.tables["surfaces"] = frame.shared(MaterialBuffers, frame.scene.materials, texels)
