# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's arrays to the GPU: meshes, where they stand, what they are made of. Each only when it changed."""

from ...scene import Change
from ..buffers import Placement, Surfaces, Texels
from ..geometry import Coordinates, Geometry
from ..mesh_tree import MeshTree, Runs
from . import Frame, Pass


def trees_of(frame: Frame) -> tuple[MeshTree | Runs, ...]:
    """Those of the scene's meshes, or none where rays have never asked for them."""
    table = frame.tables.get("mesh_trees")
    return table.made if table is not None and table.meshes == frame.scene.meshes else ()


class Meshes(Pass):
    """Vertices and triangles of all meshes."""

    reads = ("mesh_trees",)
    makes = ("geometry",)
    depends_on = (Change.MESHES,)

    def draw(self, frame: Frame) -> None:
        frame.tables["geometry"] = frame.shared(Geometry, frame.scene.meshes, trees_of(frame))


class Unwrap(Pass):
    """Texture coordinates of all meshes."""

    reads = ("mesh_trees",)
    makes = ("coordinates",)
    depends_on = (Change.MESHES,)

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.images) > 0

    def draw(self, frame: Frame) -> None:
        frame.tables["coordinates"] = frame.shared(Coordinates, frame.scene.meshes, trees_of(frame))


class Place(Pass):
    """The matrices of the instances."""

    reads = ("geometry",)
    makes = ("placement",)
    depends_on = (Change.INSTANCES,)

    def draw(self, frame: Frame) -> None:
        placement = Placement(self.device, frame.tables["geometry"], frame.scene.instances, frame.anchor)
        frame.tables["placement"] = placement
        frame.counts["bytes_uploaded"] += placement.bytes


class Colours(Pass):
    """Materials and images."""

    makes = ("surfaces",)
    depends_on = (Change.MATERIALS,)

    def draw(self, frame: Frame) -> None:
        texels = frame.shared(Texels, frame.scene.images)
        frame.tables["surfaces"] = frame.shared(Surfaces, frame.scene.materials, texels)
