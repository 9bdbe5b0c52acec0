# SPDX-License-Identifier: GPL-3.0-or-later
"""What a light's nodes multiply its radiance by: Light Falloff, the profile of an IES Texture, and an image.

The output Quadratic of Light Falloff is the physical decrease of light: the factor is 1. By Linear it is the distance,
by Constant its square. Smooth makes light weaker near its source. A profile gives a factor for each direction. An image
gives a colour for each direction of a spot, or for each point of an area. For a light with a size, each sample averages
both over other points of it, so the mean over all samples is exact.
"""

from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from ...sampling.dimensions import Dimension, draw, fixed_point
from ...scene import Lights, LightShape
from ...scene.light_profiles import AZIMUTHS, POLAR_ANGLES
from ..culling.surface_bounds import SurfaceBounds, dot
from .light_type import LightBounds
from .point import MAX_BOUND

#: Functions of the lights' interface that glsl/lights/modulation.glsl replaces; the plain ones have this prefix.
PLAIN = "plain_"
REPLACED = "irradiance", "sample", "emitted", "virtual_weight", "transformed_irradiance", "even_radiance"

#: Points of a light with a size whose mean profile or colour a sample has.
MEAN_POINTS = 16

#: Texels of a profile for each azimuth: each has four factors, the last of which is the first of the next texel.
GLSL_CONSTANTS = {"profile_azimuths": AZIMUTHS, "profile_texels": (POLAR_ANGLES - 1) // 3}


def has_falloff(lights: Lights) -> np.ndarray:
    """(L,) bool: whether a light's radiance depends on the distance."""
    return (lights.falloff_power > 0) | (lights.falloff_smooth > 0.0)


def has_profile(lights: Lights) -> np.ndarray:
    """(L,) bool: whether a light's radiance depends on the direction by a profile."""
    profiled: np.ndarray = lights.profile >= 0
    return profiled


def has_image(lights: Lights) -> np.ndarray:
    """(L,) bool: whether a light's colour is that of an image."""
    pictured: np.ndarray = lights.image >= 0
    return pictured


def variant(lights: Lights) -> dict[str, np.ndarray]:
    """See LightType.variant: whether a light has falloff, and points of means of profiles and images."""
    points = np.where((lights.radius > 0.0) | (lights.shape <= LightShape.ELLIPSE), MEAN_POINTS, 1)
    return {
        "falloff": has_falloff(lights),
        "profile": points * has_profile(lights),
        "light_image": points * has_image(lights),
    }


def mean_points(sample: int) -> dict[str, tuple[int, ...]]:
    """Uniforms of the points of means in a sample."""
    return {"mean_point_shift": fixed_point(draw(Dimension.MEAN_POINT, sample=sample))}


@dataclass(frozen=True)
class FalloffBounds:
    """See LightBounds: those of K lights without falloff, and what multiplies them. Columns are (K,1) float32."""

    plain: LightBounds
    position: np.ndarray  # (3,K,1) m
    extent: np.ndarray  # m, of any of its points from the position
    power: np.ndarray
    smooth: np.ndarray  # m²

    @classmethod
    def of(cls, plain: LightBounds, lights: Lights, anchor: np.ndarray) -> Self:
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
        """(K,N) of distances (K,N) m: see modulation.glsl."""
        square = distance * distance
        smooth = np.divide(square, square + self.smooth, out=np.ones_like(square), where=self.smooth > 0.0)
        return np.where(self.power == 2, square, np.where(self.power == 1, distance, np.float32(1.0))) * smooth
