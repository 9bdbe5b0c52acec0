# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of Blender's node Sky Texture."""

from dataclasses import dataclass, replace
from enum import StrEnum
from math import copysign, cos, fmod, pi, sin

import numpy as np


class SkyModel(StrEnum):
    """Models, by Blender's names. Nishita is Blender's single scattering before 5.0."""

    PREETHAM = "PREETHAM"
    HOSEK_WILKIE = "HOSEK_WILKIE"
    NISHITA = "NISHITA"
    SINGLE_SCATTERING = "SINGLE_SCATTERING"
    MULTIPLE_SCATTERING = "MULTIPLE_SCATTERING"


#: Models without a disc of the sun, whose sun is at `sun_direction`.
ANALYTIC = frozenset({SkyModel.PREETHAM, SkyModel.HOSEK_WILKIE})


@dataclass(frozen=True)
class Sky:
    """A sky, with the defaults of a new node. Each model reads only its own settings.

    Directions are those of the node's vector: x east, y north, z up.
    """

    model: SkyModel = SkyModel.MULTIPLE_SCATTERING

    # Preetham and Hosek-Wilkie
    sun_direction: tuple[float, float, float] = (0.0, 0.0, 1.0)  # of any length
    turbidity: float = 2.2  # 1 … 10
    ground_albedo: float = 0.3  # 0 … 1; Hosek-Wilkie

    # single and multiple scattering
    sun_disc: bool = True
    sun_size: float = 0.009512044489383698  # angular diameter, rad
    sun_intensity: float = 1.0  # factor of the disc's radiance
    sun_elevation: float = 0.2617993950843811  # above the horizon, rad; any angle
    sun_rotation: float = 0.0  # from north to east, rad; any angle
    altitude: float = 100.0  # of the camera, m
    air_density: float = 1.0  # these three relative to Earth's atmosphere
    aerosol_density: float = 1.0  # called dust before Blender 5.0
    ozone_density: float = 1.0

    def with_wrapped_sun(self) -> "Sky":
        """The same sky, whose sun has an elevation within ±π/2."""
        elevation, rotation = fmod(self.sun_elevation, 2.0 * pi), self.sun_rotation
        if abs(elevation) >= pi:
            elevation -= copysign(2.0 * pi, elevation)
        if abs(elevation) > 0.5 * pi:
            elevation, rotation = copysign(pi, elevation) - elevation, rotation + pi
        return replace(self, sun_elevation=elevation, sun_rotation=fmod(rotation, 2.0 * pi))


def direction_at(elevation: float, rotation: float) -> tuple[float, float, float]:
    """Unit vector of an elevation above the horizon and a rotation from north to east, rad."""
    return cos(elevation) * sin(rotation), cos(elevation) * cos(rotation), sin(elevation)


def sun_cosines(sky: Sky, elevation: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
    """(R,A) float32 cosines of the angle to the sun at elevations (R,) and azimuths (A,) from it, rad."""
    horizontal = cos(sky.sun_elevation) * np.outer(np.cos(elevation), np.cos(azimuth))
    return (horizontal + sin(sky.sun_elevation) * np.sin(elevation)[:, None]).astype(np.float32)
