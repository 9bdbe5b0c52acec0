# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene as arrays: the only interface between Blender and the renderer.

All objects are frozen and all arrays read-only. The renderer recognises unchanged data by identity, so unchanged
meshes, images and light tables must be passed on as the same objects. SI units, radians, linear light in the working
space; world space is float64 (see `spaces`).
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, fields, replace
from enum import Enum
from functools import cached_property
from itertools import chain, repeat
from typing import Self, TypeVar

import numpy as np

from ..color import PRIMARIES, REC709
from ..shading.node_graph import NodeGraph
from .arrays import Arrays
from .camera import View
from .images import Encoding, Image
from .instances import MAX_LINK_GROUPS, Instances
from .light_images import LightImage
from .light_profiles import LightProfile
from .lights import Lights, LightShape
from .materials import MATERIAL_INPUTS, Materials
from .meshes import Mesh, bounding_boxes
from .world import World

__all__ = [
    "MATERIAL_INPUTS",
    "MAX_LINK_GROUPS",
    "Change",
    "Encoding",
    "Image",
    "Instances",
    "LightImage",
    "LightProfile",
    "LightShape",
    "Lights",
    "Materials",
    "Mesh",
    "NodeGraph",
    "Scene",
    "View",
    "World",
    "bounding_boxes",
]

Record = TypeVar("Record", bound=Arrays)


@dataclass(frozen=True, eq=False)
class Scene:
    """A Blender scene at one frame. `warnings`: sentences about data that was left out."""

    meshes: tuple[Mesh, ...]
    instances: Instances
    materials: Materials
    images: tuple[Image, ...]
    lights: Lights
    world: World
    graphs: tuple[NodeGraph, ...] = ()
    light_profiles: tuple[LightProfile, ...] = ()
    light_images: tuple[LightImage, ...] = ()
    warnings: tuple[str, ...] = ()
    working_space: str = REC709  # of all colours; a key of color.PRIMARIES
    transparent_bounces: int = 8  # surfaces through which light passes at most

    def __post_init__(self) -> None:
        if self.working_space not in PRIMARIES:
            raise ValueError(f"colours in {self.working_space} are not known")

    @property
    def triangle_count(self) -> int:
        """Triangles of all instances."""
        sizes = np.array([len(mesh.triangles) for mesh in self.meshes], np.int64)
        return int(sizes[self.instances.mesh].sum()) if len(sizes) else 0

    @property
    def has_gloss(self) -> bool:
        """Whether any material has other lobes than Lambert's, or bumps that take away some of that one's light."""
        return any(graph.has_gloss or graph.bump_shadowing for graph in self.graphs)

    @property
    def has_coat(self) -> bool:
        """Whether any material has a lobe above the others."""
        return any(graph.has_coat for graph in self.graphs)

    @property
    def has_extra(self) -> bool:
        """Whether any material has anisotropy, sheen or a rough diffuse lobe."""
        return any(graph.has_extra for graph in self.graphs)

    @property
    def bump_shadowing(self) -> int:
        """By which function bumps of materials take away light; 0: those of none do."""
        return max((graph.bump_shadowing for graph in self.graphs), default=0)

    @property
    def has_transparency(self) -> tuple[bool, bool]:
        """Whether camera rays pass through any material, and whether shadow rays do."""
        camera, shadow = (self.materials.transparency >= 0).any(0).tolist()
        return camera, shadow

    @property
    def tints(self) -> np.ndarray:
        """(M,) bool: the materials that tint what the camera sees through them. Without rows if all are opaque."""
        of_graphs = np.array([*(graph.tints for graph in self.graphs), False])
        tints: np.ndarray = of_graphs[self.materials.transparency[:, 0]]  # -1 is the last one
        return tints

    @property
    def has_emission_graphs(self) -> bool:
        """Whether the radiance of any material varies."""
        return bool((self.materials.emission_graph >= 0).any())

    @property
    def traces_graphs(self) -> bool:
        """Whether the graph of any material traces rays."""
        return any(graph.traces_rays for graph in self.graphs)

    def reusing(self, other: Self) -> Self:
        """This scene, with equal objects replaced by the other's; if all are equal, the other scene itself."""
        tables = {name: getattr(self, name) for name in ("instances", "materials", "lights", "world")}
        for name, value in tables.items():
            if value.equals(getattr(other, name)):
                tables[name] = getattr(other, name)
        images = reused(self.images, other.images)
        light_images = reused(self.light_images, other.light_images)
        merged = replace(self, **tables, images=images, light_images=light_images)
        is_same = all(getattr(merged, member.name) == getattr(other, member.name) for member in fields(self))
        return other if is_same else merged

    def without_graphs(self, graphs: Collection[int]) -> Self:
        """The scene with the materials of these graphs in their base color. Shaders of the other ones are the same."""
        graph = np.where(np.isin(self.materials.graph, list(graphs)), -1, self.materials.graph)
        return replace(self, materials=replace(self.materials, graph=graph.astype(np.int32)))

    @cached_property
    def extent(self) -> float:
        """Largest side of the box around all instances, m, from their bounding spheres."""
        if not len(self.instances.mesh):
            return 1.0
        low, high = bounding_boxes(self.meshes).swapaxes(0, 1)
        centre = ((low + high) / 2.0)[self.instances.mesh]
        radius = np.linalg.norm(high - low, axis=1)[self.instances.mesh] / 2.0
        linear = self.instances.world_from_object[:, :3, :3]
        world_centre = np.einsum("nij,nj->ni", linear, centre) + self.instances.world_from_object[:, :3, 3]
        world_radius = (radius * np.linalg.norm(linear, axis=(1, 2)))[:, None]
        return float(((world_centre + world_radius).max(0) - (world_centre - world_radius).min(0)).max())


def reused(new: Sequence[Record], old: Sequence[Record]) -> tuple[Record, ...]:
    """The new records, with equal ones at the same index replaced by the old ones."""
    pairs = zip(new, chain(old, repeat(None)), strict=False)
    return tuple(
        before if before is not None and (before is now or before.equals(now)) else now for now, before in pairs
    )


class Change(Enum):
    """Inputs outside of the passes that a pass can depend on."""

    MESHES = "meshes"
    INSTANCES = "instances"
    MATERIALS = "materials, their images and graphs"
    NORMALS = "normals of materials"
    EMISSION_VIEW = "view, if graphs of emission read it"
    GLOSS = "whether any material has gloss"
    LIGHTS = "lights"
    WORLD = "world"
    VIEW = "view"
    PIXEL_GRID = "grid of samples' positions in the pixels"
    SAMPLE = "sample"
