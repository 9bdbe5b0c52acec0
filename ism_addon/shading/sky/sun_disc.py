# SPDX-License-Identifier: GPL-3.0-or-later
"""The disc of the sun in skies of single and multiple scattering, as Cycles renders it.

Its radiance is interpolated linearly over the elevation from the colour that the sun has at the disc's lowest point to
the one at its highest, and falls to the limb: at the angle a from the centre of a disc of radius r it is
1 - 0.6 (1 - √(1 - (a/r)²)) of that.
"""

from dataclasses import dataclass

import numpy as np

from . import multiple_scattering, single_scattering
from .parameters import ANALYTIC, Sky, SkyModel, direction_at
from .xyz import rgb_from_xyz, without_negative

#: Cycles' least angular diameter, rad.
MIN_SIZE = 0.0005
LIMB_DARKENING = 0.6
#: Quadrature of the irradiance: numbers of radii and of angles about the centre.
RADII, ANGLES = 32, 128


@dataclass(frozen=True)
class Sun:
    """The disc of a sky's sun. Radiances are linear Rec.709, W/(sr m²), negative outside of its gamut."""

    direction: np.ndarray  # (3,) unit vector from the ground to the disc's centre
    angular_diameter: float  # rad
    elevations: tuple[float, float]  # rad, that have these radiances
    radiances: np.ndarray  # (2,3) in the disc's centre line, without limb darkening
    horizon: float  # elevation, rad, below which the disc is hidden
    hides_sky: bool  # whether the disc replaces the sky's radiance instead of being added to it


def sun(sky: Sky) -> Sun | None:
    """The sky's disc; None if the model has none, it is not shown, or it is hidden or black."""
    if sky.model in ANALYTIC or not sky.sun_disc:
        return None
    sky = sky.with_wrapped_sun()
    size = max(sky.sun_size, MIN_SIZE)
    lowest, highest = sky.sun_elevation - 0.5 * size, sky.sun_elevation + 0.5 * size
    if sky.model == SkyModel.MULTIPLE_SCATTERING:
        colors = [multiple_scattering.sun_xyz(sky, elevation) for elevation in (lowest, highest)]
    elif highest > 0.0:
        colors = [single_scattering.sun_xyz(sky, max(elevation, 0.0)) for elevation in (lowest, highest)]
    else:
        return None
    # As in Cycles: in float32, which rounds the solid angles of small discs.
    solid_angle = 2.0 * np.pi * (1.0 - np.cos(np.float32(0.5 * size)))
    radiances = sky.sun_intensity / solid_angle * rgb_from_xyz(np.array(colors))
    is_nishita = sky.model == SkyModel.NISHITA
    horizon = 0.0 if is_nishita else multiple_scattering.horizon(sky)
    if highest <= horizon or not radiances.any():
        return None
    elevations = max(lowest, 0.0) if is_nishita else lowest, highest
    direction = np.array(direction_at(sky.sun_elevation, sky.sun_rotation))
    return Sun(direction, size, elevations, radiances, horizon, is_nishita)


def sun_radiance(sun: Sun, directions: np.ndarray) -> np.ndarray:
    """(N,3) float32 radiance, W/(sr m²), of the disc in directions (N,3), unit vectors float64; 0 outside of it."""
    away, near = (np.linalg.norm(directions + sign * sun.direction, axis=1) for sign in (-1.0, 1.0))
    offset = 2.0 * np.arctan2(away, near) / (0.5 * sun.angular_diameter)
    elevation = np.arcsin(np.clip(directions[:, 2], -1.0, 1.0))
    low, high = sun.elevations
    height = ((elevation - low) / (high - low))[:, None]
    color = without_negative(sun.radiances[0] + height * (sun.radiances[1] - sun.radiances[0]))
    limb = 1.0 - LIMB_DARKENING * (1.0 - np.sqrt(np.maximum(1.0 - offset * offset, 0.0)))
    is_seen = (offset < 1.0) & (elevation >= sun.horizon)
    return color * np.where(is_seen, limb, 0.0).astype(np.float32)[:, None]


def sun_irradiance(sun: Sun) -> np.ndarray:
    """(3,) float64 irradiance, W/m², by the disc of a surface that faces its centre."""
    points, weights = np.polynomial.legendre.leggauss(RADII)
    half = 0.25 * sun.angular_diameter
    radius, angle = half * (1.0 + points), 2.0 * np.pi * (np.arange(ANGLES) + 0.5) / ANGLES
    side = np.cross(sun.direction, np.eye(3)[np.abs(sun.direction).argmin()])
    side /= np.linalg.norm(side)
    around = np.outer(np.cos(angle), side) + np.outer(np.sin(angle), np.cross(sun.direction, side))
    directions = np.cos(radius)[:, None, None] * sun.direction + np.sin(radius)[:, None, None] * around
    radiance = sun_radiance(sun, directions.reshape(-1, 3)).reshape(RADII, ANGLES, 3).mean(1, dtype=np.float64)
    result: np.ndarray = 2.0 * np.pi * half * (weights * np.sin(radius) * np.cos(radius)) @ radiance
    return result
