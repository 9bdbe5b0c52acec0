# SPDX-License-Identifier: GPL-3.0-or-later
"""Light profiles: how much a light emits in which direction, as measured for IES files."""

from dataclasses import dataclass

import numpy as np

from .arrays import Arrays, array

#: Directions of a profile: azimuths from 0 to 2 pi and polar angles from 0 to pi, both ends included.
AZIMUTHS, POLAR_ANGLES = 145, 361


@dataclass(frozen=True, eq=False)
class LightProfile(Arrays):
    """Factors of a light's radiance, the largest of which is 1, for directions in the light's space.

    Polar angles are from -z; azimuth 0 is towards -y, and a quarter of a turn later it is towards -x, as in Cycles.
    """

    factors: np.ndarray = array("float32 145 361", max_abs=1.0, is_signed=False)

    def at(self, directions: np.ndarray) -> np.ndarray:
        """(N,) the factors of directions (N,3) of any length, interpolated linearly, as in shaders."""
        x, y, z = directions.T / np.linalg.norm(directions, axis=1)
        polar = np.arccos(np.clip(-z, -1.0, 1.0)) * ((POLAR_ANGLES - 1) / np.pi)
        azimuth = (np.arctan2(x, y) + np.pi) * ((AZIMUTHS - 1) / (2.0 * np.pi))
        row, column = np.minimum(azimuth.astype(int), AZIMUTHS - 2), np.minimum(polar.astype(int), POLAR_ANGLES - 2)
        along, across = azimuth - row, polar - column
        first, second = (
            (1.0 - across) * self.factors[rows, column] + across * self.factors[rows, column + 1]
            for rows in (row, row + 1)
        )
        result: np.ndarray = (1.0 - along) * first + along * second
        return result
