# SPDX-License-Identifier: GPL-3.0-or-later
"""Single scattering: Nishita et al., "Display of The Earth Taking into Account Atmospheric Scattering", SIGGRAPH 1993.

The atmosphere is that of Blender's node. Light is scattered by air and aerosols, and absorbed by aerosols and ozone.
Their densities depend on the height alone: optical depths are computed for these three, and spectra from them.
"""

import numpy as np

from . import phase
from .atmosphere import Atmosphere
from .parameters import Sky, SkyModel, sun_cosines
from .spectrum import IRRADIANCE, OZONE_ABSORPTION, RAYLEIGH_SCATTERING, XYZ_FROM_SPECTRUM
from .table import COLUMNS, ROWS, from_nodes, nodes

EARTH = Atmosphere(6360e3, 60e3)  # m
#: Cycles limits the altitude to these, m. At the upper one its rounding makes the sky, which is nearly black there, an
#: eighth brighter than ours.
MIN_ALTITUDE, MAX_ALTITUDE = 1.0, 59999.0
RAYLEIGH_HEIGHT, MIE_HEIGHT = 8e3, 1.2e3  # scale heights, m
OZONE_CENTRE, OZONE_EXTENT = 25e3, 15e3  # m
MIE_SCATTERING = 2e-5  # 1/m, at all wavelengths
MIE_EXTINCTION = 1.11 * MIE_SCATTERING
MIE_ANISOTROPY = 0.76
#: (3,21) extinction, 1/m, by air, aerosols and ozone of density 1.
EXTINCTION = np.stack([RAYLEIGH_SCATTERING, np.full_like(IRRADIANCE, MIE_EXTINCTION), OZONE_ABSORPTION])
#: (21,2,3) CIE XYZ of what air and aerosols scatter of transmitted spectra.
SCATTERED_XYZ = XYZ_FROM_SPECTRUM[:, None] * np.stack(
    [IRRADIANCE * RAYLEIGH_SCATTERING, IRRADIANCE * MIE_SCATTERING], 1
).reshape(-1, 2, 1)
#: Number of segments of a ray from the camera.
SEGMENTS = 32
#: Quadrature along rays to the sun, where densities fall about exponentially: Gauss-Laguerre, in units of RANGE.
RANGE = 25.0
_nodes, _weights = np.polynomial.laguerre.laggauss(8)
QUADRATURE = [(x / RANGE, w * np.exp(x) / RANGE) for x, w in zip(_nodes.tolist(), _weights.tolist(), strict=True)]
#: Number of azimuths that a row is interpolated from, to 2e-4 of the brightest, where the ground does not hide the sun.
NODES = 24
#: Rows that are computed together: as many as fit a cache.
ROWS_AT_ONCE = 4
#: The horizon's colour has faded to black where the sine of the angle below it is this.
LAST_SINE = 0.4


def densities(squared: np.ndarray) -> np.ndarray:
    """(3,…) air, aerosols and ozone, 1 where they are densest, at squared heights (…)."""
    height = EARTH.height(squared)
    ozone = np.maximum(1.0 - np.abs(height - OZONE_CENTRE) / OZONE_EXTENT, 0.0)
    return np.stack([np.exp(height / -RAYLEIGH_HEIGHT), np.exp(height / -MIE_HEIGHT), ozone])


def optical_depth(squared: np.ndarray, along: np.ndarray) -> np.ndarray:
    """(3,…) integrals of the densities along rays into space, m; arguments as of Atmosphere.to_space."""
    length = EARTH.to_space(squared, along)
    depth = np.zeros((3, *length.shape), length.dtype)
    for node, weight in QUADRATURE:
        depth += weight * densities(EARTH.onward(squared, along, node * length))
    return depth * length


def camera_altitude(sky: Sky) -> float:
    """m above the sea."""
    return min(max(sky.altitude, MIN_ALTITUDE), MAX_ALTITUDE)


def table(sky: Sky) -> np.ndarray:
    """(ROWS,COLUMNS/2,3) float32 CIE XYZ: the left half of the sky's table. The sun's elevation is within ± π/2."""
    upper = ROWS // 2
    # Rows have the elevation of their lower edges and texels the azimuth of their left edges.
    elevation = 0.5 * np.pi * (np.arange(upper) / upper) ** 2
    if sky.model == SkyModel.NISHITA:
        elevation *= 1.0 + 1.0 / ROWS
    azimuth = np.pi - 2.0 * np.pi * np.arange(COLUMNS // 2) / COLUMNS  # from the sun
    if sky.sun_elevation >= 0.0:
        samples, interpolation = nodes(NODES), from_nodes(azimuth, NODES)
    else:  # the ground's shadow has edges
        samples, interpolation = azimuth, np.eye(len(azimuth), dtype=np.float32)
    parts = [slice(first, first + ROWS_AT_ONCE) for first in range(0, upper, ROWS_AT_ONCE)]
    sampled = np.concatenate([_scattered(sky, elevation[part], samples) for part in parts])
    by_air, by_aerosols = np.split(interpolation @ sampled, 2, -1)
    cosine = sun_cosines(sky, elevation, azimuth)[..., None]
    xyz = by_air * phase.rayleigh(cosine) + by_aerosols * phase.cornette_shanks(cosine, MIE_ANISOTROPY)
    return np.concatenate([_ground(sky.model)[:, None, None] * xyz[0], xyz])


def _ground(model: SkyModel) -> np.ndarray:
    """(ROWS/2,) float32: the fraction of the horizon's light in the rows below it."""
    rows = np.arange(ROWS // 2, 0, -1) - (0.5 if model == SkyModel.NISHITA else 0.0)
    sines = np.sin(0.5 * np.pi * (rows / (ROWS // 2)) ** 2)
    return (np.maximum(1.0 - sines / LAST_SINE, 0.0) ** 3).astype(np.float32)


def _scattered(sky: Sky, elevation: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
    """(R,A,6) CIE XYZ of what air and aerosols scatter, without their phase functions. Azimuths are from the sun."""
    altitude = camera_altitude(sky)
    from_centre, start = EARTH.radius + altitude, EARTH.squared(altitude)
    along = (from_centre * np.sin(elevation)).astype(np.float32)[:, None]
    segment = EARTH.to_space(start, along) / SEGMENTS
    distance = segment * (np.arange(SEGMENTS, dtype=np.float32) + 0.5)
    squared = EARTH.onward(start, along, distance)  # (R,S)
    scale = np.array([sky.air_density, sky.aerosol_density, sky.ozone_density], np.float32)
    density = scale[:, None, None] * densities(squared) * segment
    to_sun = distance[:, None] * sun_cosines(sky, elevation, azimuth)[..., None]
    to_sun += np.float32(from_centre * np.sin(sky.sun_elevation))  # (R,A,S)
    with np.errstate(over="ignore", invalid="ignore"):  # in the ground
        depth = scale[:, None, None, None] * optical_depth(squared[:, None], to_sun)
        depth += np.cumsum(density, 2)[:, :, None]
        spectra = np.exp(-np.tensordot(depth, EXTINCTION.astype(np.float32), (0, 0)))
    if sky.sun_elevation < 0.0:
        spectra[to_sun * to_sun >= squared[:, None]] = 0.0
    xyz = np.tensordot(spectra, SCATTERED_XYZ.astype(np.float32), 1)
    return np.einsum("raskx,krs->rakx", xyz, density[:2]).reshape(*to_sun.shape[:2], -1)


def sun_xyz(sky: Sky, elevation: float) -> np.ndarray:
    """(3,) CIE XYZ of the irradiance, W/m², by a sun at this elevation, rad. Cycles leaves out ozone."""
    altitude = camera_altitude(sky)
    along = np.array((EARTH.radius + altitude) * np.sin(elevation))
    depth = optical_depth(np.array(EARTH.squared(altitude)), along) * (sky.air_density, sky.aerosol_density, 0.0)
    result: np.ndarray = (IRRADIANCE * np.exp(-depth @ EXTINCTION)) @ XYZ_FROM_SPECTRUM
    return result
