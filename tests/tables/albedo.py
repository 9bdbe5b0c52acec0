# SPDX-License-Identifier: GPL-3.0-or-later
"""Directional albedos of GGX lobes, on the grids of Cycles' tables: midpoint rule over visible normals.

Cycles interpolates tables of 16 to 32 entries linearly, also where albedos are curved: at grazing angles by up to a
tenth of the light below a dielectric. Tables on the same grids have the same error, so that pictures agree.
"""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from tests.tables import ggx

#: Roughness and cosine of Cycles' grids begin here, where they would be 0.
SMALLEST = 1e-4
#: Cycles' last index of refraction has this parameter instead of 1, where it would be infinite.
LARGEST_PARAMETER = 0.99
ROUGHNESS_COUNT = COSINE_COUNT = 32
SHAPE_COUNT = 16
#: Exponents of Cycles' table of Schlick's reflectance whose mean it takes for an exponent of 5.
SCHLICK_EXPONENTS = 40.0 / 7.0, 35.0 / 8.0
#: Midpoints of the visible normals: azimuths in half a turn, the other half mirrors them, and heights.
AZIMUTHS, HEIGHTS = 96, 192


def grid(count: int) -> np.ndarray:
    return np.maximum(np.linspace(0.0, 1.0, count), SMALLEST)


def reflections(roughness: float, cosine: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """For C viewers: (C,N,3) directions of equal probability in the lobe, (C,N) v·h, (C,1,3) towards the viewer."""
    u, v = (np.arange(AZIMUTHS) + 0.5) / (2 * AZIMUTHS), (np.arange(HEIGHTS) + 0.5) / HEIGHTS
    u, v = (each.ravel() for each in np.meshgrid(u, v))
    wi = ggx.direction(cosine)[:, None]
    h = ggx.sample_visible_normal(wi, roughness**2, u, v)
    return ggx.reflect(wi, h), (wi * h).sum(-1), wi


def directional_albedo(roughness: float, cosine: np.ndarray) -> np.ndarray:
    """(C,): single scattering, without Fresnel."""
    wo, _, wi = reflections(roughness, cosine)
    shadow_i = 1.0 + ggx.smith_lambda(wi[..., 2], roughness**2)
    shadow_o = ggx.smith_lambda(wo[..., 2], roughness**2)
    return np.where(wo[..., 2] > 0.0, shadow_i / (shadow_i + shadow_o), 0.0).mean(1)


def mean_albedo(roughness: float) -> float:
    """Mean of the directional albedo, weighted by the cosine."""
    return mean_of(partial(directional_albedo, roughness))


def mean_shape(roughness: float, cosine: np.ndarray, shape: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """(C,) mean of `shape`(v·h) over visible normals, of which those that reflect below the horizon count as 0.

    So Cycles defines the albedo mix(f0, f90, s): as if what microfacets shadow still arrived.
    """
    wo, cos_h, _ = reflections(roughness, cosine)
    return np.where(wo[..., 2] > 0.0, shape(cos_h), 0.0).mean(1)


def glass_albedo(roughness: float, cosine: np.ndarray, eta: float) -> np.ndarray:
    """(C,): single scattering of a dielectric's reflection and refraction together. `eta`: at least 1."""
    wo, cos_h, wi = reflections(roughness, cosine)
    h = ggx.half_vector(wi, wo)
    through = wi / eta - (cos_h / eta - np.sqrt(1.0 - (1.0 - cos_h**2) / eta**2))[..., None] * h
    reflected, shadow_i = ggx.fresnel_dielectric(cos_h, eta), 1.0 + ggx.smith_lambda(wi[..., 2], roughness**2)
    passed = [
        shadow_i / (shadow_i + ggx.smith_lambda(z, roughness**2)) * (z > 0.0) for z in (wo[..., 2], through[..., 2])
    ]
    return (reflected * passed[0] + (1.0 - reflected) * passed[1]).mean(1)


def mean_of(albedo: Callable[[np.ndarray], np.ndarray]) -> float:
    """Mean of a directional albedo, weighted by the cosine."""
    node, weight = np.polynomial.legendre.leggauss(64)
    cosine = 0.5 + 0.5 * node
    return float((weight * cosine * albedo(cosine)).sum())


def albedo_table() -> np.ndarray:
    """(32,32) by roughness and cosine."""
    return np.stack([directional_albedo(roughness, grid(COSINE_COUNT)) for roughness in grid(ROUGHNESS_COUNT)])


def mean_albedo_table() -> np.ndarray:
    """(32,) by roughness."""
    return np.array([mean_albedo(roughness) for roughness in grid(ROUGHNESS_COUNT)])


def dielectric_table() -> np.ndarray:
    """(16,16,16) by roughness, cosine and √√F0 of the index of refraction."""
    return shape_table([partial(ggx.dielectric_shape, eta=eta) for eta in indices_of_refraction()])


def indices_of_refraction() -> np.ndarray:
    """(16,) by √√F0."""
    squares = np.minimum(grid(SHAPE_COUNT), LARGEST_PARAMETER) ** 2
    return (1.0 + squares) / (1.0 - squares)


def glass_table() -> np.ndarray:
    """(16,16,16) by roughness, cosine and √√F0 of the index of refraction."""
    at, etas = grid(SHAPE_COUNT), indices_of_refraction()
    return np.stack([np.stack([glass_albedo(roughness, at, eta) for eta in etas], -1) for roughness in at])


def mean_glass_table() -> np.ndarray:
    """(16,16) by roughness and √√F0 of the index of refraction."""
    means = [
        [mean_of(partial(glass_albedo, roughness, eta=eta)) for eta in indices_of_refraction()]
        for roughness in grid(SHAPE_COUNT)
    ]
    return np.array(means)


def schlick_table() -> np.ndarray:
    """(16,16) by roughness and cosine."""
    return shape_table([lambda cosine, power=power: (1.0 - cosine) ** power for power in SCHLICK_EXPONENTS]).mean(-1)


def shape_table(shapes: Sequence[Callable[[np.ndarray], np.ndarray]]) -> np.ndarray:
    """(16,16,N) by roughness, cosine and shape."""
    at = grid(SHAPE_COUNT)
    return np.stack([np.stack([mean_shape(roughness, at, shape) for shape in shapes], -1) for roughness in at])
