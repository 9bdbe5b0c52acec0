# SPDX-License-Identifier: GPL-3.0-or-later
"""Look-ups in the add-on's tables of lobes, as in glsl/materials/lobe_tables.glsl but in float64."""

import numpy as np

from ism_addon.gpu.materials.lobe_tables import tables
from tests.tables.ltc import rotated


def interpolate(table: np.ndarray, *coordinates: np.ndarray) -> np.ndarray:
    """(…,C) values of a table at coordinates from 0 to 1, linear between its entries along each axis."""
    count = table.shape[0] - 1
    at = np.clip(coordinates[0], 0.0, 1.0) * count
    cell = np.minimum(at.astype(int), count - 1)
    if len(coordinates) == 1:
        low, high = table[cell], table[cell + 1]
    else:
        rows = np.stack([interpolate(row, *coordinates[1:]) for row in table])
        index = np.arange(len(cell))
        low, high = rows[cell, index], rows[cell + 1, index]
    weight = (at - cell).reshape(-1, *(1,) * (low.ndim - 1))
    return low * (1.0 - weight) + high * weight


def ltc_inverse(roughness: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """(N,4) a, b, c, d."""
    alpha = roughness**2
    scale = np.stack([np.ones_like(alpha), alpha, alpha, alpha], -1)
    table = tables()["ltc"].astype(np.float64)
    inverse = interpolate(table, roughness, np.sqrt(1.0 - cosine)) * scale
    return rotated(inverse, cosine, np.sqrt(1.0 - cosine**2))


def ggx_albedo(roughness: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    return interpolate(tables()["albedo"], roughness, cosine)


def ggx_mean_albedo(roughness: np.ndarray) -> np.ndarray:
    return interpolate(tables()["mean_albedo"], roughness)


def root_of(eta: np.ndarray) -> np.ndarray:
    """√√F0 of an index of refraction."""
    return np.sqrt(np.abs((eta - 1.0) / (eta + 1.0)))


def dielectric_s(roughness: np.ndarray, cosine: np.ndarray, eta: np.ndarray) -> np.ndarray:
    return interpolate(tables()["dielectric"], roughness, cosine, root_of(eta))


def glass_albedo(roughness: np.ndarray, cosine: np.ndarray, eta: np.ndarray) -> np.ndarray:
    return interpolate(tables()["glass"][..., :-1], roughness, cosine, 15.0 / 14.0 * root_of(eta))


def glass_mean_albedo(roughness: np.ndarray, eta: np.ndarray) -> np.ndarray:
    return interpolate(tables()["mean_glass"], roughness, root_of(eta))


def schlick_s(roughness: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    return interpolate(tables()["schlick"], roughness, cosine)


def sheen_ltc(roughness: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """(N,3) a, b and the albedo."""
    return interpolate(tables()["sheen"], roughness, cosine)
