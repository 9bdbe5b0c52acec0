# SPDX-License-Identifier: GPL-3.0-or-later
"""What tiles show, bounded: their surfaces by a box, and their normals by a cone."""

from dataclasses import dataclass, fields
from typing import Self

import numpy as np

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


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Of vectors (3,…)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
