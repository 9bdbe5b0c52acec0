# SPDX-License-Identifier: GPL-3.0-or-later
"""Suns: parallel light, or light of uniform radiance from a cap of directions. They have no position."""

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Self

import numpy as np

from ...color import REC709, luminance
from ...sampling.points import disk
from ...scene import Lights, LightShape
from ...scene.limits import MAX_DISTANCE
from ...spaces import orthonormal
from ..culling.receiver_region import ReceiverRegion
from ..culling.surface_bounds import SurfaceBounds, dot
from .light_records import light_records
from .point import MAX_BOUND

#: Length of a shadow ray for culling, m: it leaves every scene.
RAY_LENGTH = 4.0 * MAX_DISTANCE


def sines(lights: Lights) -> np.ndarray:
    """(L,) sines of half of the suns' angles."""
    return np.sin(lights.spread.astype(np.float64) / 2.0)


def shadow_half_angles(lights: Lights) -> np.ndarray:
    """(L,) rad: half of the suns' angles, as shadows see them: sun_centre in GLSL scales the tangents of directions."""
    half = np.minimum(lights.spread.astype(np.float64) / 2.0, 0.5 * np.pi - 1e-6)
    return np.arctan(lights.shadow_softness * np.tan(half))


@dataclass(frozen=True)
class SunLightBounds:
    """K suns by what bounds them: float32, columns (K,1)."""

    direction: np.ndarray  # (3,K,1) unit, towards the sun
    sine: np.ndarray
    luminance: np.ndarray  # of the irradiance of a surface that faces it

    @classmethod
    def of(cls, lights: Lights, working_space: str = REC709) -> Self:
        columns = -lights.normal.T, sines(lights), np.abs(lights.emission) @ luminance(working_space)
        return cls(*(column[..., None].astype(np.float32) for column in columns))

    @property
    def peak(self) -> np.ndarray:
        """(K,1) luminance of the irradiance of a hemisphere of the sun's radiance."""
        with np.errstate(divide="ignore", over="ignore"):
            return np.minimum(self.luminance / (self.sine * self.sine), MAX_BOUND).astype(np.float32)

    def __getitem__(self, rows: slice) -> Self:
        return type(self)(*(getattr(self, member.name)[..., rows, :] for member in fields(self)))

    def irradiance(self, surfaces: SurfaceBounds) -> tuple[np.ndarray, np.ndarray]:
        """See LightBounds: by the least tilt towards the cap."""
        cosine = np.clip(dot(self.direction, surfaces.axis[:, None]), -1.0, 1.0)
        highest = np.minimum(surfaces.max_cosine(cosine) + self.sine, 1.0)
        upper_bound = self.luminance * np.where(surfaces.exists & (highest > 0.0), highest, 0.0)
        return upper_bound.astype(np.float32), (self.luminance * np.maximum(cosine, 0.0)).astype(np.float32)


class SunLight:
    """See LightType."""

    name = "sun"
    shapes: tuple[int, ...] = (LightShape.SUN,)
    glsl = Path(__file__).with_suffix(".glsl")
    min_virtual_lights = 1
    parallel = True
    max_rays = 4  # its penumbrae are narrow, so that few neighbors help: chosen by the scene garden of `bench error`

    def records(self, lights: Lights, anchor: np.ndarray) -> np.ndarray:
        table = light_records(lights, anchor, "normal")
        table["radius"] = sines(lights)
        return table

    def bounds(self, lights: Lights, anchor: np.ndarray, working_space: str) -> SunLightBounds:
        return SunLightBounds.of(lights, working_space)

    def shadow_ends(self, lights: Lights, anchor: np.ndarray, receivers: np.ndarray) -> np.ndarray:
        angles, half = np.arccos(np.clip(-lights.normal.T, -1.0, 1.0)), shadow_half_angles(lights)
        farthest, nearest = np.minimum(angles + half, np.pi), np.maximum(angles - half, 0.0)
        return RAY_LENGTH * np.cos([farthest, nearest])[..., None] + receivers[:, :, None]

    def heights(self, lights: Lights, anchor: np.ndarray, boxes: np.ndarray) -> np.ndarray:
        return np.full((boxes.shape[2], len(lights.shape)), np.inf)

    def is_narrow(self, lights: Lights) -> np.ndarray:
        return np.zeros(len(lights.shape), bool)

    def is_exact(self, lights: Lights, row: int) -> bool:
        return True

    def is_hard(self, lights: Lights, row: int) -> bool:
        return bool(lights.spread[row] * lights.shadow_softness[row] == 0.0)

    def is_round(self, lights: Lights, row: int) -> bool:
        return True

    def virtual_lights(self, lights: Lights, row: int, squares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        axis = lights.normal[row]
        across = 2.0 * np.sin(shadow_half_angles(lights)[row]) * disk(squares)  # even by projected area, as irradiance
        along = np.sqrt(1.0 - (across * across).sum(1))
        return np.zeros((len(squares), 3)), across @ np.stack(orthonormal(axis)) + along[:, None] * axis

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
        """A third of the value of an occluder facing the sun is added to all, so that edge-on ones are not lost."""
        assert region is not None
        direction = -lights.normal[row]
        offset: np.ndarray = points - np.array(region.centre, np.float32)
        along = offset @ direction.astype(np.float32)
        across = np.sqrt(np.maximum(np.einsum("nk,nk->n", offset, offset) - along * along, 0.0))
        # The rays to the sun are in a cone whose sides touch the region.
        half_angle = min(float(shadow_half_angles(lights)[row]), 0.5 * np.pi - 1e-3)
        width = across - np.float32(np.tan(half_angle)) * along
        may_occlude = (along > -region.radius) & (width < (region.radius + np.sqrt(area)) / np.cos(half_angle))
        facing = np.abs(normals @ direction.astype(np.float32))
        return np.where(may_occlude, facing + np.float32(1.0 / 3.0), np.float32(0.0))

    def variant(self, lights: Lights) -> dict[str, np.ndarray]:
        has_angle = lights.spread > 0.0
        return {"suns_with_angle": has_angle, "suns_without_angle": ~has_angle}
