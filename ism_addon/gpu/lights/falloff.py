# SPDX-License-Identifier: GPL-3.0-or-later
"""Light Falloff nodes: the radiance of a light is multiplied by a function of the distance that grows with it.

The node's output Quadratic is the physical decrease of light: the factor is 1. By Linear it is the distance, by
Constant its square. Smooth makes light weaker near its source.
"""

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Self

import numpy as np

from ...scene import Lights, LightShape
from ..culling.surface_bounds import SurfaceBounds, dot
from .point import MAX_BOUND

if TYPE_CHECKING:
    from . import LightBounds

#: Functions of the lights' interface that glsl/lights/falloff.glsl replaces by those of the same name with this prefix.
PLAIN = "plain_"
REPLACED = "irradiance", "sample", "emitted", "virtual_weight"


def has_falloff(lights: Lights) -> np.ndarray:
    """(L,) bool: whether a light's radiance depends on the distance."""
    return (lights.falloff_power > 0) | (lights.falloff_smooth > 0.0)


@dataclass(frozen=True)
class FalloffBounds:
    """See LightBounds: those of K lights without falloff, and what multiplies them. Columns are (K,1) float32."""

    plain: "LightBounds"
    position: np.ndarray  # (3,K,1) m
    extent: np.ndarray  # m, of any of its points from the position
    power: np.ndarray
    smooth: np.ndarray  # m²

    @classmethod
    def of(cls, plain: "LightBounds", lights: Lights, anchor: np.ndarray) -> Self:
        """With the falloff of these lights, about the anchor (3,)."""
        sides = 0.5 * (np.linalg.norm(lights.axis_u, axis=1) + np.linalg.norm(lights.axis_v, axis=1))
        extent = np.where(lights.shape <= LightShape.ELLIPSE, sides, lights.radius)
        columns = (lights.position - anchor).T, extent, lights.falloff_power, lights.falloff_smooth
        return cls(plain, *(column[..., None].astype(np.float32) for column in columns))

    @property
    def peak(self) -> np.ndarray:
        """(K,1): see LightBounds; at a distance of 1 m."""
        return self.plain.peak

    def __getitem__(self, rows: slice) -> Self:
        return type(self)(self.plain[rows], *(getattr(self, each.name)[..., rows, :] for each in fields(self)[1:]))

    def irradiance(self, surfaces: SurfaceBounds) -> tuple[np.ndarray, np.ndarray]:
        """See LightBounds: the factor at the farthest point of a box, and in its middle."""
        upper_bound, estimate = self.plain.irradiance(surfaces)
        half = (surfaces.high - surfaces.low) * np.float32(0.5)
        to = self.position - (surfaces.low + half)[:, None]
        distance = np.sqrt(dot(to, to))
        farthest = distance + np.sqrt(dot(half, half)) + self.extent
        with np.errstate(over="ignore"):
            upper_bound, estimate = upper_bound * self.factor(farthest), estimate * self.factor(distance)
        return np.minimum(upper_bound, np.float32(MAX_BOUND)), np.minimum(estimate, np.float32(MAX_BOUND))

    def factor(self, distance: np.ndarray) -> np.ndarray:
        """(K,N) of distances (K,N) m: see falloff.glsl."""
        square = distance * distance
        smooth = np.divide(square, square + self.smooth, out=np.ones_like(square), where=self.smooth > 0.0)
        return np.where(self.power == 2, square, np.where(self.power == 1, distance, np.float32(1.0))) * smooth
