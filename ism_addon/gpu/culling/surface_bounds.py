# SPDX-License-Identifier: GPL-3.0-or-later
"""How much light lamps can bring to what blocks of pixels show: a bound, and a guess.

A block's surfaces lie in a sphere about the middle of their box, and their normals in a cone. What a light sends is
bounded by its nearest point, the least tilt of either side, and the middle of its spread; nothing comes from
behind a light's plane, from below all of a block's horizons, or from outside a spread's cone.
"""

from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from ...color import REC709, luminance
from ...radiometry import MIN_SPREAD, light_areas, plane_normals, spread_terms
from ...scene import Lights

#: What float32 positions may be off by, as a part of their distances from the origin.
POSITION_ROUNDING = np.float32(1e-6)

#: How much farther bounds reach than what was seen of a surface: it goes on between the pixels, and up to the next one.
MARGIN = np.float32(1.0 / 8.0)
MIN_CONE_ANGLE = np.float32(0.01)  # rad


@dataclass(frozen=True)
class SurfaceBounds:
    """What N blocks, or parts of their depth, show: float32, anchor space."""

    seen: np.ndarray  # (N,) bool: whether that is anything
    low: np.ndarray  # (3,N) m: the box around its surfaces
    high: np.ndarray  # (3,N) m
    axis: np.ndarray  # (3,N) unit: of the cone of normals
    half_angle: np.ndarray  # (N,) rad

    @classmethod
    def of(cls, lowest: np.ndarray, highest: np.ndarray, facing: np.ndarray) -> Self:
        """From targets (R,C,4) of CullLights, with a margin."""
        lowest, highest, facing = (np.ascontiguousarray(row.reshape(-1, 4).T) for row in (lowest, highest, facing))
        margin, turn = MARGIN * (highest[:3] - lowest[:3]), np.arccos(np.clip(facing[3], -1.0, 1.0))
        half_angle = np.minimum((1.0 + MARGIN) * turn + MIN_CONE_ANGLE, np.float32(np.pi))
        return cls(lowest[3] > 0.0, lowest[:3] - margin, highest[:3] + margin, facing[:3], half_angle)

    @classmethod
    def around(cls, points: np.ndarray, normals: np.ndarray) -> Self:
        """Around each of N points (3,N) alone."""
        count = points.shape[1]
        return cls(np.ones(count, bool), points, points, normals, np.zeros(count, np.float32))

    def some(self, chosen: np.ndarray) -> Self:
        """Those numbered, or chosen of (N,)."""
        return type(self)(*(getattr(self, member.name)[..., chosen] for member in fields(self)))

    def turn_to(self, other: Self) -> np.ndarray:
        """(N,) rad: the half angle of a cone about our axes around the other's cones."""
        return np.arccos(np.clip((self.axis * other.axis).sum(0), -1.0, 1.0)) + other.half_angle

    def hold(self, other: Self) -> np.ndarray:
        """(N,) bool: whether all that the other shows is in these."""
        inside = (self.low <= other.low).all(0) & (self.high >= other.high).all(0)
        return ~other.seen | (self.seen & inside & (self.half_angle >= self.turn_to(other)))

    def joined(self, other: Self) -> Self:
        """Around what either has."""
        widest = np.minimum(np.maximum(self.half_angle, self.turn_to(other)), np.float32(np.pi))
        half_angle = np.where(self.seen, np.where(other.seen, widest, self.half_angle), other.half_angle)
        return type(self)(
            self.seen | other.seen,
            np.minimum(self.low, other.low),
            np.maximum(self.high, other.high),
            np.where(self.seen, self.axis, other.axis),
            half_angle,
        )


@dataclass(frozen=True)
class LightBounds:
    """K lights by what bounds them: float32, anchor space, columns (K,1)."""

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
            np.abs(lights.radiance) @ luminance(working_space),
            np.maximum(lights.spread, MIN_SPREAD) / 2.0,
            *spread_terms(lights.spread).T,
        )
        return cls(*(column[..., None].astype(np.float32) for column in columns))

    @property
    def peak(self) -> np.ndarray:
        """(K,1): what a spread makes of the radiance straight ahead, which it makes more of."""
        return np.where(self.scale == 0.0, np.float32(1.0), self.tangent * self.scale)

    def outside(self, ahead: np.ndarray, across: np.ndarray, slack: np.ndarray) -> np.ndarray:
        """(K,N) bool: whether places, so far (m) from the centre, are more than `slack` beyond the spread's cone."""
        return across * np.cos(self.half_angle) - ahead * np.sin(self.half_angle) > slack

    def __getitem__(self, some: slice) -> Self:
        return type(self)(*(getattr(self, member.name)[..., some, :] for member in fields(self)))


def irradiance_bound(bounds: SurfaceBounds, lamps: LightBounds) -> tuple[np.ndarray, np.ndarray]:
    """Luminance (K,N) float32 of the irradiance that nothing hides: never more than the first; about the second."""
    half = (bounds.high - bounds.low) * np.float32(0.5)
    centre, size = bounds.low + half, np.abs(bounds.low) + np.abs(bounds.high)
    to = lamps.position - centre[:, None]
    distance = np.sqrt(dot(to, to)) + np.float32(1e-20)
    radius = np.sqrt(dot(half, half)) + POSITION_ROUNDING * (size.sum(0) + np.abs(lamps.position).sum(0))
    slack = radius + lamps.radius
    ahead = -dot(to, lamps.normal)
    upright = np.clip(dot(to, bounds.axis[:, None]) / distance, -1.0, 1.0)
    cosine, sine = np.cos(bounds.half_angle), np.sin(bounds.half_angle)
    least_tilt = np.where(
        upright >= cosine, np.float32(1.0), upright * cosine + np.sqrt(1.0 - upright * upright) * sine
    )
    height, above, near = ahead + radius, least_tilt * distance + slack, distance - slack
    across = np.sqrt(np.maximum(distance * distance - ahead * ahead, 0.0))
    lit = bounds.seen & (height > 0.0) & (above > 0.0) & ~lamps.outside(ahead, across, slack)
    wide = lamps.scale == 0.0
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):  # where they touch, or it is not lit
        solid = lamps.area / (near * near) * np.minimum(height / near, 1.0) * np.minimum(above / near, 1.0)
        spread = np.maximum(lamps.tangent - across / ahead, 0.0) * lamps.scale
        whole = lamps.luminance * np.where(wide, np.float32(1.0), spread) * lamps.area * upright
        guess = np.pi * whole * ahead / (distance * (np.pi * distance * distance + lamps.area))
    most = np.where(lit, lamps.luminance * lamps.peak * np.where(near > 0.0, np.minimum(solid, np.pi), np.pi), 0.0)
    return most.astype(np.float32), np.where((ahead > 0.0) & (upright > 0.0), guess, 0.0).astype(np.float32)


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Of vectors (3,…)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
