# SPDX-License-Identifier: GPL-3.0-or-later
"""Spot lights: point lights that emit into a cone, which is elliptical under a scale that is not uniform.

What is farther from the cone than the radius is not lit.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np

from ...color import REC709
from ...sampling.points import disk
from ...scene import Lights, LightShape
from ...spaces import orthonormal
from ..culling.surface_bounds import SurfaceBounds, dot
from .light_records import light_records
from .point import PointLight, PointLightBounds

#: Smallest change of the cosine over which the attenuation falls: float32 resolves no less.
MIN_FADE = 1e-6


def is_circular(lights: Lights) -> np.ndarray:
    """(L,) bool: whether the cone is circular."""
    lengths = np.linalg.norm([lights.axis_u, lights.axis_v], axis=2)
    return (np.abs(lengths - 1.0) < 1e-5).all(0)


@dataclass(frozen=True)
class SpotLightBounds(PointLightBounds):
    """K lights by what bounds them, see PointLightBounds."""

    axis: np.ndarray  # (3,K,1) unit
    half_angle: np.ndarray  # rad: of the widest circular cone around the light's

    @classmethod
    def of(cls, lights: Lights, anchor: np.ndarray, working_space: str = REC709) -> Self:
        point = PointLightBounds.of(lights, anchor, working_space)
        widest = np.maximum(np.linalg.norm(lights.axis_u, axis=1), np.linalg.norm(lights.axis_v, axis=1))
        half = np.clip(lights.spread.astype(np.float64) / 2.0, 0.0, np.pi / 2.0 - 1e-6)
        columns = lights.normal.T, np.arctan(np.tan(half) * widest)
        added = (column[..., None].astype(np.float32) for column in columns)
        return cls(point.position, point.radius, point.luminance, *added)

    def irradiance(self, surfaces: SurfaceBounds) -> tuple[np.ndarray, np.ndarray]:
        upper_bound, estimate = super().irradiance(surfaces)
        half = (surfaces.high - surfaces.low) * np.float32(0.5)
        offset = (surfaces.low + half)[:, None] - self.position
        radius = np.sqrt(dot(half, half))
        along = dot(offset, self.axis)
        across = np.sqrt(np.maximum(dot(offset, offset) - along * along, 0.0))
        beyond = across * np.cos(self.half_angle) - along * np.sin(self.half_angle)  # m, from the cone
        rounding = np.float32(1e-5) * (np.abs(along) + across)
        is_outside = beyond > radius + self.radius + rounding
        return np.where(is_outside, 0.0, upper_bound), np.where(beyond > self.radius, 0.0, estimate)


class SpotLight(PointLight):
    """See LightType."""

    name = "spot"
    shapes: tuple[int, ...] = (LightShape.SPOT,)
    glsl = Path(__file__).with_suffix(".glsl")
    min_virtual_lights = 1

    def records(self, lights: Lights, anchor: np.ndarray) -> np.ndarray:
        table = light_records(lights, anchor, "radius", "soft_falloff", "normal")
        for name in ("axis_u", "axis_v"):
            axes = getattr(lights, name)
            table[name] = axes / (axes * axes).sum(1, keepdims=True)
        table["circular_cone"] = is_circular(lights)
        cosine = np.cos(lights.spread.astype(np.float64) / 2.0)
        table["cone_cosine"] = cosine
        table["cone_scale"] = 1.0 / np.maximum((1.0 - cosine) * lights.blend, MIN_FADE)
        return table

    def bounds(self, lights: Lights, anchor: np.ndarray, working_space: str) -> SpotLightBounds:
        return SpotLightBounds.of(lights, anchor, working_space)

    def heights(self, lights: Lights, anchor: np.ndarray, boxes: np.ndarray) -> np.ndarray:
        middle, half = boxes.sum(0) / 2.0, (boxes[1] - boxes[0]) / 2.0
        position = ((lights.position - anchor) * lights.normal).sum(1)
        return middle.T @ lights.normal.T - position + half.T @ np.abs(lights.normal).T + lights.radius

    def is_narrow(self, lights: Lights) -> np.ndarray:
        return np.ones(len(lights.shape), bool)

    def is_exact(self, lights: Lights, row: int) -> bool:
        """Of elliptical cones with a radius the attenuation is linearized, see spot.glsl."""
        return bool(lights.radius[row] == 0.0 or is_circular(lights)[row])

    def virtual_lights(self, lights: Lights, row: int, squares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        axis = lights.normal[row]
        across = 2.0 * lights.radius[row] * lights.shadow_softness[row] * disk(squares)
        return across @ np.stack(orthonormal(axis)), np.broadcast_to(axis, (len(squares), 3))
