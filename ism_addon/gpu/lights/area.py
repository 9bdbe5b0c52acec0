# SPDX-License-Identifier: GPL-3.0-or-later
"""Area lights: rectangles and ellipses, with Blender's spread.

The irradiance on a tile is bounded by the smallest distance, by the smallest angles to the normals of light and tile,
and by the radiance in the middle of the spread. It is 0 behind the light's plane, if the light is below the horizons of
all of the tile's surfaces, and outside the spread's cone.
"""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Self

import numpy as np

from ...color import REC709, luminance
from ...radiometry import MIN_SPREAD, light_areas, plane_normals, spread_terms
from ...sampling.points import disk
from ...scene import Lights, LightShape
from ...spaces import orthonormal
from ..culling.receiver_region import ReceiverRegion
from ..culling.surface_bounds import POSITION_ROUNDING, SurfaceBounds, dot
from .light_records import light_records


@dataclass(frozen=True)
class AreaLightBounds:
    """Bounds of K lights: float32, anchor space, columns (K,1)."""

    position: np.ndarray  # (3,K,1) m
    normal: np.ndarray  # (3,K,1) unit
    radius: np.ndarray  # m
    area: np.ndarray  # m²
    luminance: np.ndarray  # of the radiance
    half_angle: np.ndarray  # rad: of the spread's cone
    tangent: np.ndarray  # see radiometry.spread_terms
    scale: np.ndarray

    @classmethod
    def of(cls, lights: Lights, anchor: np.ndarray, working_space: str = REC709) -> Self:
        """All lights, about the anchor (3,)."""
        u, v = lights.axis_u, lights.axis_v
        columns = (
            (lights.position - anchor).T,
            plane_normals(lights).T,
            np.maximum(np.linalg.norm(u + v, axis=1), np.linalg.norm(u - v, axis=1)) / 2.0,
            light_areas(lights),
            np.abs(lights.emission) @ luminance(working_space),
            np.maximum(lights.spread, MIN_SPREAD) / 2.0,
            *spread_terms(lights.spread).T,
        )
        return cls(*(column[..., None].astype(np.float32) for column in columns))

    @property
    def spread_peak(self) -> np.ndarray:
        """(K,1): factor of the spread on the radiance along the normal, where it is largest."""
        return np.where(self.scale == 0.0, np.float32(1.0), self.tangent * self.scale)

    @property
    def peak(self) -> np.ndarray:
        """(K,1) luminance of the irradiance of a light that fills a receiver's hemisphere."""
        return np.pi * self.luminance * self.spread_peak

    def is_outside_cone(self, along: np.ndarray, across: np.ndarray, slack: np.ndarray) -> np.ndarray:
        """(K,N) bool: whether points are more than `slack` outside the spread's cone. All in m.

        `along`, `across`: coordinates from the light's centre, along its normal and perpendicular to it.
        """
        return across * np.cos(self.half_angle) - along * np.sin(self.half_angle) > slack

    def __getitem__(self, rows: slice) -> Self:
        return type(self)(*(getattr(self, member.name)[..., rows, :] for member in fields(self)))

    def irradiance(self, surfaces: SurfaceBounds) -> tuple[np.ndarray, np.ndarray]:
        """Luminance of the unshadowed irradiance: an upper bound and an estimate, each (K,N) float32."""
        half = (surfaces.high - surfaces.low) * np.float32(0.5)
        centre, size = surfaces.low + half, np.abs(surfaces.low) + np.abs(surfaces.high)
        to = self.position - centre[:, None]
        distance = np.sqrt(dot(to, to)) + np.float32(1e-20)
        rounding = POSITION_ROUNDING * (size.sum(0) + np.abs(self.position).sum(0))
        radius = np.sqrt(dot(half, half)) + rounding
        slack = radius + self.radius
        along = -dot(to, self.normal)
        upright = np.clip(dot(to, surfaces.axis[:, None]) / distance, -1.0, 1.0)
        max_ahead, near = along + dot(np.abs(self.normal), half[:, None]) + rounding, distance - slack
        above = surfaces.max_cosine(upright) * distance + slack
        across = np.sqrt(np.maximum(distance * distance - along * along, 0.0))
        lit = surfaces.exists & (max_ahead > 0.0) & (above > 0.0) & ~self.is_outside_cone(along, across, slack)
        wide = self.scale == 0.0
        # Where light and tile touch, and where the tile is not lit.
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            solid_angle = self.area / (near * near) * np.minimum(max_ahead / near, 1.0) * np.minimum(above / near, 1.0)
            spread = np.maximum(self.tangent - across / along, 0.0) * self.scale
            intensity_cosine = self.luminance * np.where(wide, np.float32(1.0), spread) * self.area * upright
            estimate = np.pi * intensity_cosine * along / (distance * (np.pi * distance * distance + self.area))
        upper_bound = np.where(
            lit, self.luminance * self.spread_peak * np.where(near > 0.0, np.minimum(solid_angle, np.pi), np.pi), 0.0
        )
        estimate = np.where((along > 0.0) & (upright > 0.0), estimate, 0.0)
        return upper_bound.astype(np.float32), estimate.astype(np.float32)


class AreaLight:
    """See LightType."""

    name = "area"
    shapes: tuple[int, ...] = (LightShape.RECTANGLE, LightShape.ELLIPSE)
    glsl = Path(__file__).with_suffix(".glsl")
    min_virtual_lights = 1
    parallel = False
    max_rays = 1

    def records(self, lights: Lights, anchor: np.ndarray) -> np.ndarray:
        table = light_records(lights, anchor, "axis_u", "axis_v")
        table["normal"] = plane_normals(lights)
        table["tangent"] = orthonormal(table["normal"])[0]
        table["spread_tangent"], table["spread_scale"] = spread_terms(lights.spread).T
        return table

    def bounds(self, lights: Lights, anchor: np.ndarray, working_space: str) -> AreaLightBounds:
        return AreaLightBounds.of(lights, anchor, working_space)

    def shadow_ends(self, lights: Lights, anchor: np.ndarray, receivers: np.ndarray) -> np.ndarray:
        centre, half = (lights.position - anchor).T, (np.abs(lights.axis_u) + np.abs(lights.axis_v)).T / 2.0
        half = half * lights.shadow_softness
        return np.stack([centre - half, centre + half])[..., None]

    def heights(self, lights: Lights, anchor: np.ndarray, boxes: np.ndarray) -> np.ndarray:
        normals = plane_normals(lights)
        middle, half = boxes.sum(0) / 2.0, (boxes[1] - boxes[0]) / 2.0
        return middle.T @ normals.T - ((lights.position - anchor) * normals).sum(1) + half.T @ np.abs(normals).T

    def is_narrow(self, lights: Lights) -> np.ndarray:
        return lights.spread < np.pi

    def is_exact(self, lights: Lights, row: int) -> bool:
        return True

    def is_hard(self, lights: Lights, row: int) -> bool:
        return bool(lights.shadow_softness[row] == 0.0)

    def is_round(self, lights: Lights, row: int) -> bool:
        return bool(lights.shape[row] == LightShape.ELLIPSE)

    def virtual_lights(self, lights: Lights, row: int, squares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        across = disk(squares) if lights.shape[row] == LightShape.ELLIPSE else squares - 0.5
        offsets = lights.shadow_softness[row] * across @ np.stack([lights.axis_u[row], lights.axis_v[row]])
        return offsets, np.broadcast_to(plane_normals(lights.select(slice(row, row + 1))), offsets.shape)

    def solid_angles(
        self,
        lights: Lights,
        row: int,
        anchor: np.ndarray,
        points: np.ndarray,
        normals: np.ndarray,
        area: float,
        region: ReceiverRegion | None,
    ) -> np.ndarray:
        """A third of the value of an occluder facing the light is added to all, so that edge-on ones are not lost."""
        bounds = AreaLightBounds.of(lights.select(slice(row, row + 1)), anchor)
        to = points - bounds.position.ravel()
        square = np.einsum("nk,nk->n", to, to) + (bounds.area.ravel() / np.float32(12.0) + np.float32(1e-12))
        facing = np.abs(np.einsum("nk,nk->n", to, normals)) / np.sqrt(square)
        extent = np.sqrt(area)
        along = to @ bounds.normal.ravel()
        across = np.sqrt(np.maximum(square - along * along, 0.0))
        lit = (along > -extent) & ~bounds.is_outside_cone(along, across, bounds.radius + extent)[0]
        return np.where(lit, (facing + np.float32(1.0 / 3.0)) / square, np.float32(0.0))

    def variant(self, lights: Lights) -> dict[str, np.ndarray]:
        rectangle = lights.shape == LightShape.RECTANGLE
        return {"rectangles": rectangle, "ellipses": ~rectangle, "spreads": lights.spread < np.pi}
