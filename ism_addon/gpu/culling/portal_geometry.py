# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays that look for portals, and the rectangles that they cross: see portals.py."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

#: Rays that the box around them is fitted to, and occluded ones that measure a rectangle: all would take longer.
MEASURING_RAYS = 4000

#: How far from an opening rays may pass that it is extended to, in its sides; and how many extensions are tried.
MAX_EXTENSION, EXTENSIONS = 0.5, 8


@dataclass(frozen=True)
class Rays:
    """N rays: origins and directions (N,3) in anchor space, and whether each (N,) is unoccluded."""

    origins: np.ndarray
    directions: np.ndarray
    unoccluded: np.ndarray
    radiance: np.ndarray  # (N,) from there; rays are distributed by it, times the cosine
    weight: float = 1.0  # of an occluded one: how many it stands for

    def __getitem__(self, rows: np.ndarray | slice) -> "Rays":
        origins, directions, unoccluded = self.origins[rows], self.directions[rows], self.unoccluded[rows]
        return Rays(origins, directions, unoccluded, self.radiance[rows], self.weight)

    def with_others(self, others: "Rays") -> "Rays":
        """Together with others; occluded ones of both count as the others do."""
        return Rays(
            np.concatenate([self.origins, others.origins]),
            np.concatenate([self.directions, others.directions]),
            np.concatenate([self.unoccluded, others.unoccluded]),
            np.concatenate([self.radiance, others.radiance]),
            others.weight,
        )

    @property
    def fewer(self) -> "Rays":
        """The same ones without most of those that are occluded."""
        step = max(int((~self.unoccluded).sum()) // MEASURING_RAYS, 1)
        rows = np.concatenate([np.flatnonzero(self.unoccluded), np.flatnonzero(~self.unoccluded)[::step]])
        return replace(self[rows], weight=float(step))

    def unevenness(self, rows: np.ndarray) -> float:
        """Of the radiance of the unoccluded ones among `rows` (N,) bool: the mean square over the square of the mean.

        Means over directions. There are as many rays as radiance, so these are weighted by its inverse.
        """
        radiance = self.radiance[rows & self.unoccluded]
        return float(radiance.mean() * (1.0 / radiance).mean()) if len(radiance) else 1.0

    def fraction(self, rows: np.ndarray) -> float:
        """Of all rays, those of `rows` (N,) bool."""
        weights = np.where(self.unoccluded, 1.0, self.weight)
        return float(weights[rows].sum() / weights.sum())

    def __len__(self) -> int:
        return len(self.origins)


@dataclass(frozen=True)
class Rectangle:
    """A rectangle in anchor space, m."""

    centre: np.ndarray  # (3,)
    sides: np.ndarray  # (2,3): the vectors of both sides
    normal: np.ndarray  # (3,) unit, into the interior

    def crossed_by(self, rays: Rays) -> np.ndarray:
        """(N,) bool: whether rays cross it from the interior."""
        return (np.abs(self.crossings(rays)) <= 0.5).all(1)

    def crossings(self, rays: Rays) -> np.ndarray:
        """(N,2): where rays cross its plane from the interior, in its sides from its centre; else infinite."""
        cosine = rays.directions @ self.normal
        distance = (self.centre - rays.origins) @ self.normal / np.minimum(cosine, -1e-9)
        offset = rays.origins + distance[:, None] * rays.directions - self.centre
        points = offset @ (self.sides / (self.sides * self.sides).sum(1, keepdims=True)).T
        is_ahead = (cosine < -1e-9) & (distance > 0.0)
        return np.where(is_ahead[:, None], points, np.inf)

    def extensions(self, rays: Rays) -> Iterator["Rectangle"]:
        """Larger and larger ones, with more and more of the points where rays cross its plane beside it."""
        points = self.crossings(rays)
        beyond = np.abs(points).max(1) - 0.5
        points = points[np.argsort(beyond)[: int((beyond <= MAX_EXTENSION).sum())]]
        for count in np.unique(np.linspace(1, len(points), min(len(points), EXTENSIONS), dtype=np.int64)):
            corners = np.concatenate([points[:count], ((-0.5, -0.5), (0.5, 0.5))])
            first, last = corners.min(0), corners.max(0)
            sides = (last - first)[:, None] * self.sides
            yield Rectangle(self.centre + 0.5 * (first + last) @ self.sides, sides, self.normal)
