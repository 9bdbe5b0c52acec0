# SPDX-License-Identifier: GPL-3.0-or-later
"""What a picture is made of, as arrays: the only thing that the method knows of Blender.

Everything is frozen and every array is read-only, so "has it changed?" is "is it the same object?".
SI units, radians, linear light in the working space; world space is float64 (see `spaces`).
A mesh, an image, a light table that did not change must be passed on as the same object.
"""

from dataclasses import dataclass, fields, replace
from enum import Enum
from functools import cached_property
from itertools import chain, repeat
from typing import Self

import numpy as np

from ..color import PRIMARIES, REC709
from .camera import View
from .images import Image
from .instances import MAX_LINK_GROUPS, Instances
from .lights import Lights, LightShape
from .materials import Materials
from .meshes import Mesh, bounding_boxes
from .world import World

__all__ = [
    "MAX_LINK_GROUPS",
    "Change",
    "Image",
    "Instances",
    "LightShape",
    "Lights",
    "Materials",
    "Mesh",
    "Scene",
    "View",
    "World",
    "bounding_boxes",
]


@dataclass(frozen=True, eq=False)
class Scene:
    """One moment of a Blender scene. `warnings` are sentences about what had to be left out."""

    meshes: tuple[Mesh, ...]
    instances: Instances
    materials: Materials
    images: tuple[Image, ...]
    lights: Lights
    world: World
    warnings: tuple[str, ...] = ()
    working_space: str = REC709  # of all colours: one of color.PRIMARIES

    def __post_init__(self) -> None:
        if self.working_space not in PRIMARIES:
            raise ValueError(f"colours in {self.working_space} are not known")

    @property
    def triangle_count(self) -> int:
        """Triangles that stand in the world, instances counted."""
        sizes = np.array([len(mesh.triangles) for mesh in self.meshes], np.int64)
        return int(sizes[self.instances.mesh].sum()) if len(sizes) else 0

    def reusing(self, other: Self) -> Self:
        """This scene, with the other's own objects for all that is equal in both; the other itself if all is."""
        parts = {part: getattr(self, part) for part in ("instances", "materials", "lights", "world")}
        for part, value in parts.items():
            if value.equals(getattr(other, part)):
                parts[part] = getattr(other, part)
        others = chain(other.images, repeat(None))
        images = tuple(
            old if old is not None and (old is new or old.equals(new)) else new
            for new, old in zip(self.images, others, strict=False)
        )
        shared = replace(self, **parts, images=images)
        same = all(getattr(shared, member.name) == getattr(other, member.name) for member in fields(self))
        return other if same else shared

    @cached_property
    def extent(self) -> float:
        """Largest side of the box around all instances, m, from their bounding spheres."""
        if not len(self.instances.mesh):
            return 1.0
        low, high = bounding_boxes(self.meshes).swapaxes(0, 1)
        centre = ((low + high) / 2.0)[self.instances.mesh]
        radius = np.linalg.norm(high - low, axis=1)[self.instances.mesh] / 2.0
        linear = self.instances.world_from_object[:, :3, :3]
        middle = np.einsum("nij,nj->ni", linear, centre) + self.instances.world_from_object[:, :3, 3]
        reach = (radius * np.linalg.norm(linear, axis=(1, 2)))[:, None]
        return float(((middle + reach).max(0) - (middle - reach).min(0)).max())


class Change(Enum):
    """The parts of the input that a pass can depend on."""

    MESHES = "meshes"
    INSTANCES = "instances"
    MATERIALS = "materials and images"
    LIGHTS = "lights"
    WORLD = "world"
    VIEW = "view"
    PIXEL_GRID = "grid of samples' places in the pixels"
    SAMPLE = "sample"
