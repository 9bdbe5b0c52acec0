# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's arrays to the GPU: meshes, where they stand, what they are made of. Each only when it changed."""

from ...scene import Change
from ..buffers import Geometry, Placement, Surfaces, Texels
from . import Frame, Pass


class Meshes(Pass):
    """Vertices and triangles of all meshes."""

    makes = ("geometry",)
    depends_on = (Change.MESHES,)

    def draw(self, frame: Frame) -> None:
        frame.tables["geometry"] = frame.shared(Geometry, frame.scene.meshes)


class Place(Pass):
    """The matrices of the instances."""

    reads = ("geometry",)
    makes = ("placement",)
    depends_on = (Change.INSTANCES,)

    def draw(self, frame: Frame) -> None:
        placement = Placement(self.device.gl, frame.tables["geometry"], frame.scene.instances, frame.anchor)
        frame.tables["placement"] = placement
        frame.counts["bytes_uploaded"] += placement.bytes


class Colours(Pass):
    """Materials and images."""

    makes = ("surfaces",)
    depends_on = (Change.MATERIALS,)

    def draw(self, frame: Frame) -> None:
        texels = frame.shared(Texels, frame.scene.images)
        frame.tables["surfaces"] = frame.shared(Surfaces, frame.scene.materials, texels)
