# SPDX-License-Identifier: GPL-3.0-or-later
"""The sphere around the visible surfaces that the shadow maps of parallel light cover."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .surface_bounds import SurfaceBounds

#: Steps of the sphere's radius, relative to the next smaller one, and of its centre, relative to the radius: most
#: rotations of the camera change neither, so no map has to be drawn again.
RADIUS_STEP = 2.0**0.25
CENTRE_STEP = 1.0 / 8.0


@dataclass(frozen=True)
class ReceiverRegion:
    """A sphere in anchor space."""

    centre: tuple[float, float, float]
    radius: float  # m

    @classmethod
    def around(cls, surfaces: SurfaceBounds) -> ReceiverRegion:
        """A sphere that contains all surfaces; of radius 1 if there are none."""
        if not surfaces.exists.any():
            return cls((0.0, 0.0, 0.0), 1.0)
        low, high = surfaces.low[:, surfaces.exists].min(1), surfaces.high[:, surfaces.exists].max(1)
        middle = (low.astype(np.float64) + high) / 2.0
        # Rounding moves the centre by at most half a step along each axis.
        smallest = max(float(np.linalg.norm(high - middle)), 1e-6) / (1.0 - np.sqrt(3.0) / 2.0 * CENTRE_STEP)
        radius = RADIUS_STEP ** np.ceil(np.log(smallest) / np.log(RADIUS_STEP))
        centre = np.round(middle / (CENTRE_STEP * radius)) * (CENTRE_STEP * radius)
        return cls((float(centre[0]), float(centre[1]), float(centre[2])), float(radius))
