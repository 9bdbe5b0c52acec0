# SPDX-License-Identifier: GPL-3.0-or-later
"""The geometry of a spherical atmosphere, by squared heights: (R + h)² - R² = h (2R + h) of heights h above radius R.

These are precise in float32, where R + h is not.
"""

from dataclasses import dataclass
from typing import TypeVar

import numpy as np

Number = TypeVar("Number", float, np.ndarray)


@dataclass(frozen=True)
class Atmosphere:
    """Its lower radius and its thickness, in one unit of length."""

    radius: float
    thickness: float

    def squared(self, height: Number) -> Number:
        """Squared heights of heights."""
        return height * (2.0 * self.radius + height)

    def height(self, squared: np.ndarray) -> np.ndarray:
        """The inverse of `squared`."""
        return squared / (np.sqrt(self.radius**2 + squared) + self.radius)

    def to_space(self, squared: Number, along: np.ndarray) -> np.ndarray:
        """Distances from points to the end of the atmosphere. `along`: dot products of a point, from the sphere's
        centre, and its ray's unit vector."""
        return np.sqrt(along * along + (self.squared(self.thickness) - squared)) - along

    def onward(self, squared: Number, along: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """Squared heights at distances along such rays."""
        result: np.ndarray = squared + distance * (2.0 * along + distance)
        return result
