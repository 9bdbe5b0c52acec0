# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of skies: in any direction, and as images."""

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from . import hosek_wilkie, multiple_scattering, preetham, single_scattering
from .parameters import ANALYTIC, Sky, SkyModel
from .table import column_at, mirrored, row_at, sampled, sampled_grid
from .xyz import rgb_from_xyz, without_negative

#: Tables that are kept: of a few worlds, or of one that is being edited.
KEPT_TABLES = 4


def radiance(sky: Sky, directions: np.ndarray) -> np.ndarray:
    """(N,3) float32 linear Rec.709, as Cycles renders it, of unit vectors (N,3) float64; without the sun's disc."""
    if sky.model in ANALYTIC:
        sun, xyz = _analytic(sky)
        return without_negative(rgb_from_xyz(xyz(sky, directions[:, 2], directions @ sun)))
    azimuth = np.arctan2(directions[:, 1], directions[:, 0])
    row = row_at(np.arcsin(np.clip(directions[:, 2], -1.0, 1.0)))
    return without_negative(sampled(_table(sky), row, _columns(sky, azimuth)))


def sky_image(sky: Sky, width: int) -> np.ndarray:
    """(width/2,width,3) float32: `radiance` at the texel centres of an equirectangular image, bottom row first.

    As in Blender's node Environment Texture, x is in its middle and y a quarter of the width to the left.
    """
    height = width // 2
    elevation = np.pi * ((np.arange(height) + 0.5) / height - 0.5)
    azimuth = 2.0 * np.pi * (0.5 - (np.arange(width) + 0.5) / width)
    if sky.model in ANALYTIC:
        sun, xyz = _analytic(sky)
        horizontal = np.outer(np.cos(elevation), sun[0] * np.cos(azimuth) + sun[1] * np.sin(azimuth))
        sine = np.sin(elevation)[:, None]
        return without_negative(rgb_from_xyz(xyz(sky, sine, horizontal + sun[2] * sine)))
    return without_negative(sampled_grid(_table(sky), row_at(elevation), _columns(sky, azimuth)))


def _analytic(sky: Sky) -> tuple[np.ndarray, Callable[[Sky, np.ndarray, np.ndarray], np.ndarray]]:
    """The unit vector to the sun, and the function of the angles' cosines that gives CIE XYZ."""
    if sky.model == SkyModel.PREETHAM:
        return preetham.sun_of(sky), preetham.xyz
    return hosek_wilkie.sun_of(sky), hosek_wilkie.xyz


def _columns(sky: Sky, azimuth: np.ndarray) -> np.ndarray:
    """Columns of the sky's table at azimuths anticlockwise from x, rad."""
    opposite = 0.5 * np.pi - sky.with_wrapped_sun().sun_rotation - np.pi
    return column_at(opposite - azimuth)


def _table(sky: Sky) -> np.ndarray:
    """(ROWS,COLUMNS,3) float32 linear Rec.709, negative outside of its gamut."""
    elevation = sky.with_wrapped_sun().sun_elevation
    return _table_of(sky.model, elevation, sky.altitude, sky.air_density, sky.aerosol_density, sky.ozone_density)


@lru_cache(KEPT_TABLES)
def _table_of(
    model: SkyModel, sun_elevation: float, altitude: float, air: float, aerosols: float, ozone: float
) -> np.ndarray:
    sky = Sky(
        model,
        sun_elevation=sun_elevation,
        altitude=altitude,
        air_density=air,
        aerosol_density=aerosols,
        ozone_density=ozone,
    )
    module = multiple_scattering if model == SkyModel.MULTIPLE_SCATTERING else single_scattering
    table = mirrored(rgb_from_xyz(module.table(sky)))
    table.flags.writeable = False
    return table
