# SPDX-License-Identifier: GPL-3.0-or-later
"""Emissive meshes: groups of triangles, of the same radiance or of one each, see emission/emitters.py."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np

from ...color import REC709, luminance
from ...scene import Lights
from ..culling.surface_bounds import POSITION_ROUNDING, SurfaceBounds, dot
from ..emission.emissive_lights import EMISSIVE_MESH, MAX_EXACT_TRIANGLES, EmissiveLights
from ..emission.light_bvh import normal_areas
from ..gl import shader_compiler
from .light_records import light_records
from .point import PointLight, PointLightBounds

#: Heights of virtual lights over a flat and over a closed mesh, relative to its radius.
MIN_HEIGHT, MAX_HEIGHT = 1e-4, 0.02


@dataclass(frozen=True)
class EmissiveMeshBounds(PointLightBounds):
    """Bounds of K lights: float32, anchor space, columns (K,1). The luminance is that of the radiance."""

    area: np.ndarray  # m²: as seen from any direction, at most, times the relative luminance
    brightest: np.ndarray  # the largest relative luminance of a triangle

    @classmethod
    def of(cls, lights: Any, anchor: np.ndarray, working_space: str = REC709) -> Self:
        """All lights, about the anchor (3,)."""
        luminances = np.abs(lights.emission) @ luminance(working_space)
        columns = (lights.position - anchor).T, lights.radius, luminances, lights.projected_area, lights.brightest
        return cls(*(column[..., None].astype(np.float32) for column in columns))

    @property
    def peak(self) -> np.ndarray:
        """(K,1) luminance of the irradiance of a light that fills a receiver's hemisphere."""
        return np.pi * self.luminance * self.brightest

    def irradiance(self, surfaces: SurfaceBounds) -> tuple[np.ndarray, np.ndarray]:
        """See LightBounds: by all of the area at the nearest point of the sphere around it."""
        half = (surfaces.high - surfaces.low) * np.float32(0.5)
        centre, size = surfaces.low + half, np.abs(surfaces.low) + np.abs(surfaces.high)
        to = self.position - centre[:, None]
        square = dot(to, to)
        distance = np.sqrt(square) + np.float32(1e-20)
        slack = np.sqrt(dot(half, half)) + POSITION_ROUNDING * (size.sum(0) + np.abs(self.position).sum(0))
        slack = slack + self.radius
        axis_cosine = np.clip(dot(to, surfaces.axis[:, None]) / distance, -1.0, 1.0)
        above = surfaces.max_cosine(axis_cosine) * distance + slack
        near = distance - slack
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):  # where they touch, or not lit
            solid_angle = self.area / (near * near) * np.minimum(above / near, 1.0)
        most = np.pi * self.brightest
        upper_bound = np.where(near > 0.0, np.minimum(solid_angle, most), most)
        upper_bound = np.where(surfaces.exists & (above > 0.0), self.luminance * upper_bound, 0.0)
        visible = self.area * np.float32(0.75)
        estimate = np.pi * self.luminance * visible * np.maximum(axis_cosine, 0.0) / (np.pi * square + visible)
        return upper_bound.astype(np.float32), estimate.astype(np.float32)


class EmissiveMesh(PointLight):
    """See LightType; the tables are EmissiveLights. Occluders see the sphere around it as that of a point light."""

    name = "emissive_mesh"
    shapes: tuple[int, ...] = (EMISSIVE_MESH,)
    glsl = Path(__file__).with_suffix(".glsl")
    max_rays = 16  # near many triangles, samples differ much: see lights/resampled_light_sample.glsl

    def records(self, lights: Any, anchor: np.ndarray) -> np.ndarray:
        fields = "radius", "first_triangle", "triangle_count", "first_node", "leaves", "brightest"
        table = light_records(lights, anchor, *fields)
        table["axis_u"], table["axis_v"] = np.moveaxis(lights.enclosure - anchor, 1, 0)
        return table

    def bounds(self, lights: Any, anchor: np.ndarray, working_space: str) -> EmissiveMeshBounds:
        return EmissiveMeshBounds.of(lights, anchor, working_space)

    def is_narrow(self, lights: Any) -> np.ndarray:
        return lights.leaves > 0  # a sample may lead to no triangle that emits towards the receiver

    def is_exact(self, lights: Any, row: int) -> bool:
        return bool(lights.leaves[row] == 0)  # otherwise it is an estimate, unless the irradiance cache has it

    def is_round(self, lights: Any, row: int) -> bool:
        return False

    def virtual_lights(self, lights: Any, row: int, squares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Over the area, in proportion to the luminance; every other one is on the back of a two-sided triangle.

        They are off the surface, so that discs of the mesh around them lie below their horizon.
        """
        first, count = lights.first_triangle[row], lights.triangle_count[row]
        corners, one_sided = lights.corners[first : first + count], lights.one_sided[first : first + count]
        normals = normal_areas(corners)
        if lights.varies[row]:
            normals = normals * lights.colors[first : first + count, 3:]
        areas = np.linalg.norm(normals, axis=1)
        ends = np.cumsum(areas)
        chosen = np.minimum(np.searchsorted(ends, squares[:, 0] * ends[-1], "right"), np.flatnonzero(areas)[-1])
        in_triangle = (squares[:, 0] * ends[-1] - ends[chosen]) / areas[chosen] + 1.0
        root, along = np.sqrt(np.clip(in_triangle, 0.0, 1.0)), squares[:, 1]
        weights = np.stack([1.0 - root, root * (1.0 - along), root * along], 1)
        points = np.einsum("nc,nci->ni", weights, corners[chosen])
        back = ~one_sided[chosen] & (np.arange(len(squares)) % 2 == 1)
        axes = normals[chosen] / areas[chosen, None] * np.where(back, -1.0, 1.0)[:, None]
        flatness = np.linalg.norm(normals.sum(0)) / ends[-1]
        height = lights.radius[row] * (MIN_HEIGHT + MAX_HEIGHT * (1.0 - flatness))
        return points - lights.position[row] + height * axes, axes

    def variant(self, lights: Lights) -> dict[str, np.ndarray]:
        has_bvh = has_light_bvh(lights)
        varies = lights.varies if isinstance(lights, EmissiveLights) else np.zeros(len(has_bvh), bool)
        return {"meshes_with_bvh": has_bvh, "meshes_without_bvh": ~has_bvh, "mesh_colors": varies}


def has_light_bvh(lights: Lights) -> np.ndarray:
    """(L,) bool: whether a light's irradiance in GLSL is an estimate that the irradiance cache corrects."""
    return lights.leaves > 0 if isinstance(lights, EmissiveLights) else np.zeros(len(lights.shape), bool)


def limits(_constants: shader_compiler.Constants) -> str:
    """The generated file lights/emissive_limits.glsl. Leaves have fewer triangles."""
    return f"const int MAX_EXACT_TRIANGLES = {MAX_EXACT_TRIANGLES};"


shader_compiler.GENERATED["lights/emissive_limits.glsl"] = limits
