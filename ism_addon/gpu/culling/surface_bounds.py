# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds of the surfaces in tiles: a box around positions, and a cone around normals."""

from dataclasses import dataclass, fields
from typing import Self

import numpy as np

#: Relative rounding error of float32 positions.
POSITION_ROUNDING = np.float32(1e-6)

#: Margin of the bounds, relative to their size: surfaces continue between and beyond the visible points.
MARGIN = np.float32(1.0 / 8.0)
MIN_CONE_ANGLE = np.float32(0.01)  # rad


@dataclass(frozen=True)
class SurfaceBounds:
    """Bounds of the surfaces in N tiles, or in depth ranges of tiles: float32, anchor space."""

    exists: np.ndarray  # (N,) bool: whether there are surfaces
    low: np.ndarray  # (3,N) m: low corners of the bounding boxes
    high: np.ndarray  # (3,N) m: high corners
    axis: np.ndarray  # (3,N) unit vectors: axes of the cones of normals
    half_angle: np.ndarray  # (N,) rad

    @classmethod
    def of(cls, tile_min: np.ndarray, tile_max: np.ndarray, tile_normal_cone: np.ndarray) -> Self:
        """From targets (rows,columns,4) of CullLights, enlarged by a margin."""
        tile_min, tile_max, tile_normal_cone = (
            np.ascontiguousarray(row.reshape(-1, 4).T) for row in (tile_min, tile_max, tile_normal_cone)
        )
        margin, angle = MARGIN * (tile_max[:3] - tile_min[:3]), np.arccos(np.clip(tile_normal_cone[3], -1.0, 1.0))
        half_angle = np.minimum((1.0 + MARGIN) * angle + MIN_CONE_ANGLE, np.float32(np.pi))
        return cls(tile_min[3] > 0.0, tile_min[:3] - margin, tile_max[:3] + margin, tile_normal_cone[:3], half_angle)

    @classmethod
    def around(cls, points: np.ndarray, normals: np.ndarray) -> Self:
        """Bounds of N single points (3,N)."""
        count = points.shape[1]
        return cls(np.ones(count, bool), points, points, normals, np.zeros(count, np.float32))

    def select(self, rows: np.ndarray) -> Self:
        """The bounds at indices, or where a mask (N,) bool is true."""
        return type(self)(*(getattr(self, member.name)[..., rows] for member in fields(self)))

    def max_cosine(self, axis_cosine: np.ndarray) -> np.ndarray:
        """(K,N): largest cosine between a direction and the normals in a cone, from that to the cone's axis (K,N)."""
        cosine, sine = np.cos(self.half_angle), np.sin(self.half_angle)
        outside = axis_cosine * cosine + np.sqrt(1.0 - axis_cosine * axis_cosine) * sine
        return np.where(axis_cosine >= cosine, np.float32(1.0), outside)

    def half_angle_around(self, other: Self) -> np.ndarray:
        """(N,) rad: half angles, up to pi, of cones around these axes that contain the other's cones."""
        angle_between = np.arccos(np.clip((self.axis * other.axis).sum(0), -1.0, 1.0))
        return np.minimum(angle_between + other.half_angle, np.float32(np.pi))

    def contains(self, other: Self) -> np.ndarray:
        """(N,) bool: whether these bounds contain the other's."""
        inside = (self.low <= other.low).all(0) & (self.high >= other.high).all(0)
        return ~other.exists | (self.exists & inside & (self.half_angle >= self.half_angle_around(other)))

    def joined(self, other: Self) -> Self:
        """Bounds that contain these and the other's."""
        joined_angle = np.maximum(self.half_angle, self.half_angle_around(other))
        half_angle = np.where(self.exists, np.where(other.exists, joined_angle, self.half_angle), other.half_angle)
        return type(self)(
            self.exists | other.exists,
            np.minimum(self.low, other.low),
            np.maximum(self.high, other.high),
            np.where(self.exists, self.axis, other.axis),
            half_angle,
        )


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Dot product of vectors (3,…)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
