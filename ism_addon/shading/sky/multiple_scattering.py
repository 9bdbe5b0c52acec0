# SPDX-License-Identifier: GPL-3.0-or-later
"""Multiple scattering of sunlight, by Fernando García Liñán: https://fgarlin.com/posts/2024-12-06-spectral_sky

Four wavelengths, 630, 560, 490 and 430 nm, are enough. Constants of the atmosphere and the fits of its densities, of
colours, and of light that was scattered more than once are his (MIT licence), as in Blender. Lengths are in km.
"""

import numpy as np

from . import phase
from .atmosphere import Atmosphere
from .parameters import Sky, sun_cosines
from .table import COLUMNS, ROWS, from_nodes, nodes, sampled

EARTH = Atmosphere(6371.0, 100.0)
#: Cycles limits the altitude to these.
MIN_ALTITUDE, MAX_ALTITUDE = 1e-3, 99.999
GROUND_ALBEDO = 0.3
AEROSOL_ANISOTROPY = 0.8
#: Number of steps of a ray.
STEPS = 64
#: The table of transmittance: altitudes from the ground to space, and cosines of the sun's zenith angle from -1 to 1.
ALTITUDES, COSINES = 64, 256
#: Numbers of azimuths that a row is interpolated from, with the sun above and below the horizon: to 3e-4 of the
#: brightest.
NODES, NODES_BELOW = 24, 96
#: Rows that are computed together: as many as fit a cache.
ROWS_AT_ONCE = 8

# By wavelength: W/(m² nm), 1/km, and 1/km times the densities below.
IRRADIANCE = np.array([1.679, 1.828, 1.986, 1.307])
AIR_SCATTERING = np.array([6.605e-3, 1.067e-2, 1.842e-2, 3.156e-2])
OZONE_ABSORPTION = np.array([3.472e-25, 3.914e-25, 1.349e-25, 11.03e-27]) * 334.5  # mean amount, Dobson units
AEROSOL_SCATTERING = np.array([1.5908e-22, 1.7711e-22, 2.0942e-22, 2.4033e-22])
AEROSOL_ABSORPTION = np.array([2.8722e-24, 4.6168e-24, 7.9706e-24, 1.3578e-23])
AEROSOL_DENSITY, AEROSOL_BACKGROUND = 1.3681e20, 2e6  # of urban air
AEROSOL_HEIGHT = 0.73
#: Fit of the light that was scattered more than once, relative to the sun's.
SCATTERED_AGAIN = 0.02 * np.array([0.217, 0.347, 0.594, 1.0])
#: (4,3): his fit of CIE XYZ.
XYZ_FROM_SPECTRUM = np.array(
    [
        [53.386917738564668023, 22.981337506691024754, 0.0],
        [43.904844466369358263, 71.347795700053393866, 0.102506867965741307],
        [1.6137278251608962005, 18.422960591455485011, 31.742921188390805758],
        [20.762668673810577145, 2.3614213523314368527, 110.48009643252140334],
    ]
)


def densities(altitude: np.ndarray) -> np.ndarray:
    """(3,…) air, relative to the ground's, aerosols and ozone at altitudes (…)."""
    logarithm = np.log(np.maximum(altitude, 1e-4))
    return np.stack(
        [
            np.exp(-0.07771971 * np.exp(1.16364243 * logarithm)),
            AEROSOL_DENSITY * np.exp(altitude / -AEROSOL_HEIGHT) + AEROSOL_BACKGROUND,
            3.78547397e20 * np.exp(-5.55555555 * (logarithm - 3.22261) ** 2 - logarithm),
        ]
    )


def coefficients(sky: Sky) -> tuple[np.ndarray, np.ndarray]:
    """(2,4) scattering by air and aerosols, and (3,4) extinction, by unit of the densities; float32."""
    scattering = np.stack([sky.air_density * AIR_SCATTERING, sky.aerosol_density * AEROSOL_SCATTERING])
    absorption = np.stack([sky.aerosol_density * AEROSOL_ABSORPTION, sky.ozone_density * OZONE_ABSORPTION])
    extinction = np.stack([scattering[0], scattering[1] + absorption[0], absorption[1]])
    return scattering.astype(np.float32), extinction.astype(np.float32)


def altitudes(squared: np.ndarray) -> np.ndarray:
    """Those of squared heights, 0 in the ground."""
    return np.maximum(EARTH.height(squared), 0.0)


def camera_altitude(sky: Sky) -> float:
    """km above the sea."""
    return min(max(1e-3 * sky.altitude, MIN_ALTITUDE), MAX_ALTITUDE)


def horizon(sky: Sky) -> float:
    """Elevation of the ground's edge, rad: 0 or less."""
    return float(np.arcsin(EARTH.radius / (EARTH.radius + 1e-3 * max(sky.altitude, 0.0))) - 0.5 * np.pi)


def transmittance(sky: Sky, altitude: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """(…,4) of rays from altitudes (…) that have these cosines (…) with the zenith. The ground does not end them."""
    squared, along = EARTH.squared(altitude), (EARTH.radius + altitude) * cosine
    step = EARTH.to_space(squared, along) / STEPS
    total = np.zeros((3, *step.shape), step.dtype)
    for k in range(STEPS):
        total += densities(altitudes(EARTH.onward(squared, along, (k + 0.5) * step)))
    result: np.ndarray = np.exp(-np.tensordot(total * step, coefficients(sky)[1], (0, 0)))
    return result


def table(sky: Sky) -> np.ndarray:
    """(ROWS,COLUMNS/2,3) float32 CIE XYZ: the left half of the sky's table. The sun's elevation is within ± π/2."""
    altitude = np.linspace(0.0, EARTH.thickness, ALTITUDES, dtype=np.float32)
    to_sun = transmittance(sky, altitude[:, None], np.linspace(-1.0, 1.0, COSINES, dtype=np.float32))
    level = 2.0 * (np.arange(ROWS) + 0.5) / ROWS - 1.0
    elevation = 0.5 * np.pi * np.copysign(level * level, level)
    azimuth = np.pi - 2.0 * np.pi * (np.arange(COLUMNS // 2) + 0.5) / COLUMNS  # from the sun
    parts = [slice(first, first + ROWS_AT_ONCE) for first in range(0, ROWS, ROWS_AT_ONCE)]
    count = NODES if sky.sun_elevation >= 0.0 else NODES_BELOW
    scattered = np.concatenate([_scattered(sky, to_sun, elevation[part], nodes(count)) for part in parts])
    by_air, by_aerosols, again = np.split(from_nodes(azimuth, count) @ scattered, 3, -1)
    cosine = sun_cosines(sky, elevation, azimuth)[..., None]
    aerosols = phase.henyey_greenstein(cosine, AEROSOL_ANISOTROPY)
    result: np.ndarray = by_air * phase.rayleigh(cosine) + by_aerosols * aerosols + again
    return result


def _distances(altitude: float, sine: np.ndarray) -> np.ndarray:
    """(R,) float32 km to the ground or to space, along rays of these sines of the elevation (R,).

    In float32 in Cycles' order: near the horizon its rounding decides which rows meet the ground.
    """
    radius, lower, upper = np.array([altitude, 0.0, EARTH.thickness]).astype(np.float32) + np.float32(EARTH.radius)
    along = radius * sine.astype(np.float32)
    ground, space = (along * along - (radius * radius - sphere * sphere) for sphere in (lower, upper))
    is_met = (along < 0.0) & (ground >= 0.0)
    return np.where(is_met, -along - np.sqrt(np.maximum(ground, 0.0)), np.sqrt(space) - along)


def _scattered(sky: Sky, to_sun: np.ndarray, elevation: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
    """(R,A,9) CIE XYZ of sunlight that air and aerosols scatter, without their phase functions, and of light that is
    scattered again. Azimuths are from the sun; `to_sun` is the table of transmittance."""
    scattering, extinction = coefficients(sky)
    camera, sine = camera_altitude(sky), np.sin(elevation)
    step = _distances(camera, sine)[:, None] / STEPS
    distance = step * (np.arange(STEPS, dtype=np.float32) + 0.5)
    along = ((EARTH.radius + camera) * sine).astype(np.float32)[:, None]
    altitude = altitudes(EARTH.onward(EARTH.squared(camera), along, distance))  # (R,S)
    density = densities(altitude)
    lost = np.tensordot(density, extinction, (0, 0))  # (R,S,4)
    before = np.exp((lost - np.cumsum(lost, 1)) * step[..., None])
    weight = IRRADIANCE.astype(np.float32) * before * -np.expm1(-lost * step[..., None]) / np.maximum(lost, 1e-7)
    by_air, by_aerosols = (weight * density[k][..., None] * scattering[k] for k in range(2))

    cosine = distance[:, None] * sun_cosines(sky, elevation, azimuth)[..., None]
    cosine += np.float32((EARTH.radius + camera) * np.sin(sky.sun_elevation))
    cosine /= (EARTH.radius + altitude)[:, None]  # (R,A,S) of the sun's zenith angle
    column, row = 0.5 * (COSINES - 1) * (1.0 + cosine), (ALTITUDES - 1) / EARTH.thickness * altitude
    direct = sampled(to_sun, np.broadcast_to(row[:, None], column.shape), column)
    fit = SCATTERED_AGAIN.astype(np.float32) / (1.0 + 5.0 * np.exp(-17.92 * cosine))[..., None]
    ground = sampled(to_sun[:1], np.zeros_like(column), column) * cosine[..., None]
    again = fit + _from_ground(to_sun, altitude, row)[:, None] * ground
    sums = [
        np.einsum("rasw,rsw->raw", direct, by_air),
        np.einsum("rasw,rsw->raw", direct, by_aerosols),
        np.einsum("rasw,rsw->raw", again, by_air + by_aerosols),
    ]
    return np.concatenate([spectra @ XYZ_FROM_SPECTRUM.astype(np.float32) for spectra in sums], -1)


def _from_ground(to_sun: np.ndarray, altitude: np.ndarray, row: np.ndarray) -> np.ndarray:
    """(R,S,4) radiance at altitudes (R,S), which are at these rows of `to_sun`, by irradiance of the ground, 1/sr: the
    mean over all directions."""
    vertical = sampled(to_sun[:, -1:], row, np.zeros_like(row))
    visible = 0.5 * (1.0 - np.sqrt(np.maximum(1.0 - (EARTH.radius / (EARTH.radius + altitude)) ** 2, 0.0)))
    # The transmittance from the ground is that from there to the sun by that from here; both are 0 in dense air.
    transmitted = to_sun[0, -1] / np.maximum(vertical, np.finfo(np.float32).tiny)
    result: np.ndarray = GROUND_ALBEDO / np.pi * visible[..., None] * transmitted
    return result


def sun_xyz(sky: Sky, elevation: float) -> np.ndarray:
    """(3,) CIE XYZ of the irradiance, W/m², by a sun at this elevation, rad."""
    spectrum = IRRADIANCE * transmittance(sky, np.array(camera_altitude(sky)), np.sin(elevation))
    result: np.ndarray = spectrum @ XYZ_FROM_SPECTRUM
    return result
