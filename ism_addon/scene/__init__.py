# SPDX-License-Identifier: GPL-3.0-or-later
"""What a picture is made of, as arrays: the only thing that the method knows of Blender.

Everything is frozen and every array is read-only, so "has it changed?" is "is it the same object?".
SI units, radians, linear light in the working space, float32 unless said; world space is float64 (see `spaces`).
A mesh, an image, a light table that did not change must be passed on as the same object.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from enum import Enum, IntEnum
from functools import cached_property
from itertools import chain, repeat
from typing import Self

import numpy as np

from ..color import PRIMARIES, REC709

#: Groups of instances that lights may be linked to: as many as a float32 has bits for.
MAX_LINK_GROUPS = 24

#: Vertices of a mesh that is bounded together with others.
FEW = 1 << 12

#: A picture's width and height, as in Blender.
MAX_PIXELS = 1 << 16


class LightShape(IntEnum):
    """Blender's four area lights are two: a square is a rectangle, a disk an ellipse."""

    RECTANGLE = 0
    ELLIPSE = 1


@dataclass(frozen=True, eq=False)
class Arrays:
    """Base of the frozen dataclasses below: locks every array on construction. Compared by identity, but see equals."""

    def __post_init__(self) -> None:
        for member in fields(self):
            value = getattr(self, member.name)
            if isinstance(value, np.ndarray):
                value.flags.writeable = False

    def equals(self, other: Self) -> bool:
        """Whether all members have the same values."""
        pairs = ((getattr(self, member.name), getattr(other, member.name)) for member in fields(self))
        return all(np.array_equal(a, b) for a, b in pairs)


@dataclass(frozen=True, eq=False)
class Mesh(Arrays):
    """Triangles in object space. T triangles, V vertices; corners are stored per triangle."""

    positions: np.ndarray  # (V,3) m
    triangles: np.ndarray  # (T,3) uint32, into positions
    normals: np.ndarray  # unit shading normals: (V,3) of the vertices, or (T,3,3) of the corners
    uvs: np.ndarray  # (T,3,2), or (0,3,2) where the mesh has none
    materials: np.ndarray  # (T,) uint32, into Materials

    @property
    def corner_normals(self) -> np.ndarray:
        """(T,3,3) unit shading normals of the corners."""
        return self.normals if self.normals.ndim == 3 else self.normals[self.triangles]

    @cached_property
    def box(self) -> np.ndarray:
        """(2,3) float64: lowest and highest corner."""
        return np.stack([self.positions.min(0), self.positions.max(0)]).astype(np.float64)


def bounding_boxes(meshes: Sequence[Mesh]) -> np.ndarray:
    """(M,2,3) float64: Mesh.box of each. Those of small meshes that nobody has asked for yet are found together."""
    new = [mesh for mesh in meshes if "box" not in vars(mesh) and len(mesh.positions) <= FEW]
    if new:
        counts = np.array([len(mesh.positions) for mesh in new])
        positions, first = np.concatenate([mesh.positions for mesh in new]), np.cumsum(counts) - counts
        corners = [either.reduceat(positions, first, 0) for either in (np.minimum, np.maximum)]
        for mesh, box in zip(new, np.stack(corners, 1).astype(np.float64), strict=True):
            vars(mesh)["box"] = box  # where cached_property looks
    return np.concatenate([np.zeros((0, 3)), *(mesh.box for mesh in meshes)]).reshape(-1, 2, 3)


@dataclass(frozen=True, eq=False)
class Instances(Arrays):
    """Where meshes stand. Rows of one mesh need not be neighbours."""

    mesh: np.ndarray  # (I,) int32, into Scene.meshes
    world_from_object: np.ndarray  # (I,4,4) float64
    visible: np.ndarray  # (I,) bool: seen by the camera
    casts_shadow: np.ndarray  # (I,) bool
    groups: np.ndarray  # (I,) uint32: bit k, whether it belongs to group k, which lights may be linked to


@dataclass(frozen=True, eq=False)
class Materials(Arrays):
    """Lambertian surfaces: a colour, or an image that replaces it."""

    base_color: np.ndarray  # (M,3)
    image: np.ndarray  # (M,) int32, into Scene.images; -1: none


@dataclass(frozen=True, eq=False)
class Image(Arrays):
    """Texels as they are stored: sRGB-encoded, bottom row first."""

    texels: np.ndarray  # (H,W,4) uint8
    repeat: bool = True  # else the border texels go on for ever


@dataclass(frozen=True, eq=False)
class Lights(Arrays):
    """One-sided Lambertian area lights. The axes are the shape's full width and height, scale included."""

    shape: np.ndarray  # (L,) int32, LightShape
    position: np.ndarray  # (L,3) float64 world, m
    axis_u: np.ndarray  # (L,3) float64 world, m
    axis_v: np.ndarray  # (L,3) float64 world, m
    normal: np.ndarray  # (L,3) float64 world, unit: the side that shines
    radiance: np.ndarray  # (L,3) W/(sr m2), towards the normal
    spread: np.ndarray  # (L,) rad, Blender's spread: pi is a plain Lambertian light
    casts_shadow: np.ndarray  # (L,) bool
    receivers: np.ndarray  # (L,) int32: the group that it lights; -1: all
    blockers: np.ndarray  # (L,) int32: the group that casts its shadows; -1: all


@dataclass(frozen=True, eq=False)
class World(Arrays):
    """The light from everywhere, and what stands behind the scene."""

    radiance: np.ndarray  # (3,)


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

    def sharing(self, other: Self) -> Self:
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


@dataclass(frozen=True, eq=False)
class View(Arrays):
    """A camera and the picture it takes."""

    clip_from_view: np.ndarray  # (4,4) float64, OpenGL's clip space
    view_from_world: np.ndarray  # (4,4) float64, rigid; the view looks along -z
    width: int  # px
    height: int  # px
    filter_width: float = 1.5  # px that the Blackman-Harris pixel filter reaches to all sides
    transparent: bool = False  # leave the background empty instead of showing the world

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (1 <= self.width <= MAX_PIXELS and 1 <= self.height <= MAX_PIXELS):
            raise ValueError(f"a picture of {self.width}×{self.height} pixels cannot be drawn")

    def coarse(self, pixel: int) -> Self:
        """The same in pixels that are `pixel` of these wide and high, as far as they divide them."""
        return replace(self, width=max(self.width // pixel, 1), height=max(self.height // pixel, 1))


class Change(Enum):
    """The parts of the input that a pass can depend on."""

    MESHES = "meshes"
    INSTANCES = "instances"
    MATERIALS = "materials and images"
    LIGHTS = "lights"
    WORLD = "world"
    VIEW = "view"
    SAMPLE = "sample"
