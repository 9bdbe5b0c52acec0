# SPDX-License-Identifier: GPL-3.0-or-later
"""Point lights: spheres, or disks that face the receiver, of uniform radiance; without a radius, points.

A receiver sees one as a spherical cap around the direction to its position. Its irradiance is that of a point of the
same intensity until the horizon cuts the cap.
"""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Self

import numpy as np

from ...color import REC709, luminance
from ...sampling.points import sphere
from ...scene import Lights, LightShape
from ..culling.receiver_region import ReceiverRegion
from ..culling.surface_bounds import POSITION_ROUNDING, SurfaceBounds, dot
from .light_records import light_records

#: Upper limit of bounds, W/m²: at a point light without a radius there is none.
MAX_BOUND = 1e30


@dataclass(frozen=True)
class PointLightBounds:
    """K lights by what bounds them: float32, anchor space, columns (K,1)."""

    position: np.ndarray  # (3,K,1) m
    radius: np.ndarray  # m
    luminance: np.ndarray  # of the intensity

    @classmethod
    def of(cls, lights: Lights, anchor: np.ndarray, working_space: str = REC709) -> Self:
        """All lights, about the anchor (3,)."""
        columns = (lights.position - anchor).T, lights.radius, np.abs(lights.emission) @ luminance(working_space)
        return cls(*(column[..., None].astype(np.float32) for column in columns))

    @property
    def peak(self) -> np.ndarray:
        """(K,1) luminance of the irradiance inside a sphere."""
        with np.errstate(divide="ignore", over="ignore"):
            return np.minimum(self.luminance / (self.radius * self.radius), MAX_BOUND).astype(np.float32)

    def __getitem__(self, rows: slice) -> Self:
        return type(self)(*(getattr(self, member.name)[..., rows, :] for member in fields(self)))

    def irradiance(self, surfaces: SurfaceBounds) -> tuple[np.ndarray, np.ndarray]:
        """See LightBounds: by the nearest point of a box, and the least tilt towards the cap."""
        half = (surfaces.high - surfaces.low) * np.float32(0.5)
        centre, size = surfaces.low + half, np.abs(surfaces.low) + np.abs(surfaces.high)
        to = self.position - centre[:, None]
        square = dot(to, to)
        distance = np.sqrt(square) + np.float32(1e-20)
        box_radius = np.sqrt(dot(half, half)) + POSITION_ROUNDING * (size.sum(0) + np.abs(self.position).sum(0))
        axis_cosine = np.clip(dot(to, surfaces.axis[:, None]) / distance, -1.0, 1.0)
        highest = surfaces.max_cosine(axis_cosine) * distance + box_radius + self.radius
        nearest = np.maximum(distance - box_radius, self.radius)
        lit = surfaces.exists & (highest > 0.0)
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):  # at the light, or not lit
            to_cap = np.maximum(nearest - self.radius, 0.0)
            upper_bound = self.luminance * np.minimum(highest / to_cap, 1.0) / (nearest * nearest)
            estimate = self.luminance * axis_cosine / (square + self.radius * self.radius)
        upper_bound = np.where(lit, np.where(np.isfinite(upper_bound), upper_bound, MAX_BOUND), 0.0)
        estimate = np.where(axis_cosine > 0.0, np.minimum(estimate, MAX_BOUND), 0.0)
        return np.minimum(upper_bound, MAX_BOUND).astype(np.float32), estimate.astype(np.float32)


class PointLight:
    """See LightType."""

    name = "point"
    shapes: tuple[int, ...] = (LightShape.POINT,)
    glsl = Path(__file__).with_suffix(".glsl")
    min_virtual_lights = 2
    parallel = False
    max_rays = 1

    def records(self, lights: Lights, anchor: np.ndarray) -> np.ndarray:
        return light_records(lights, anchor, "radius", "soft_falloff")

    def bounds(self, lights: Lights, anchor: np.ndarray, working_space: str) -> PointLightBounds:
        return PointLightBounds.of(lights, anchor, working_space)

    def shadow_ends(self, lights: Lights, anchor: np.ndarray, receivers: np.ndarray) -> np.ndarray:
        centre, radius = (lights.position - anchor).T, lights.radius * lights.shadow_softness
        return np.stack([centre - radius, centre + radius])[..., None]

    def heights(self, lights: Lights, anchor: np.ndarray, boxes: np.ndarray) -> np.ndarray:
        return np.full((boxes.shape[2], len(lights.shape)), np.inf)

    def is_narrow(self, lights: Lights) -> np.ndarray:
        return np.zeros(len(lights.shape), bool)

    def is_exact(self, lights: Lights, row: int) -> bool:
        return True

    def is_hard(self, lights: Lights, row: int) -> bool:
        return bool(lights.radius[row] * lights.shadow_softness[row] == 0.0)

    def is_round(self, lights: Lights, row: int) -> bool:
        return True

    def virtual_lights(self, lights: Lights, row: int, squares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pairs on opposite sides of the sphere, so that each receiver is in front of one of each pair."""
        directions = sphere(squares)
        directions[1::2] = -directions[: len(directions) // 2 * 2 : 2]
        return lights.radius[row] * lights.shadow_softness[row] * directions, directions

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
        to = points - (lights.position[row] - anchor).astype(np.float32)
        square = np.einsum("nk,nk->n", to, to) + np.float32(lights.radius[row] ** 2 / 4.0 + 1e-12)
        facing = np.abs(np.einsum("nk,nk->n", to, normals)) / np.sqrt(square)
        return (facing + np.float32(1.0 / 3.0)) / square

    def variant(self, lights: Lights) -> dict[str, np.ndarray]:
        has_radius = lights.radius > 0.0
        return {"points_with_radius": has_radius, "points_without_radius": ~has_radius}
