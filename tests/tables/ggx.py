# SPDX-License-Identifier: GPL-3.0-or-later
"""The isotropic GGX reflection model of Cycles in float64: the reference for the tables of lobes.

Walter, Marschner, Li & Torrance 2007, with Smith's height-correlated masking and shadowing (Heitz 2014). Directions
(…,3) point away from the surface, whose normal is z. `wi`: towards the viewer, `wo`: towards the light, as in Cycles.
`alpha`: the square of Blender's roughness. Arguments broadcast; those of directions lack the last axis.
"""

import numpy as np


def distribution(cos_h: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """Density of microfacet normals, per steradian of the normal and area of the surface: D."""
    return alpha**2 / (np.pi * (1.0 - cos_h**2 + (alpha * cos_h) ** 2) ** 2)


def smith_lambda(cosine: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """Smith's Λ: hidden over visible projected area of the microfacets. Cosines below the horizon count as almost 0."""
    return 0.5 * (np.sqrt(1.0 + alpha**2 * (1.0 / np.maximum(cosine, 1e-100) ** 2 - 1.0)) - 1.0)


def half_vector(wi: np.ndarray, wo: np.ndarray) -> np.ndarray:
    h = wi + wo
    return h / np.linalg.norm(h, axis=-1, keepdims=True)


def evaluate(wi: np.ndarray, wo: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """BRDF times the cosine of `wo`, without Fresnel: D G / (4 cos i). 0 below the horizon."""
    cos_i, cos_o = wi[..., 2], wo[..., 2]
    visible = 1.0 / (1.0 + smith_lambda(cos_i, alpha) + smith_lambda(cos_o, alpha))
    value = distribution(half_vector(wi, wo)[..., 2], alpha) * visible / (4.0 * cos_i)
    return np.where(cos_o > 0.0, value, 0.0)


def density(wi: np.ndarray, wo: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """Probability density of `wo`, the reflection at visible normals, per steradian: D G1 / (4 cos i).

    It is a density on the sphere: some reflections go below the horizon.
    """
    cos_i = wi[..., 2]
    return distribution(half_vector(wi, wo)[..., 2], alpha) / ((1.0 + smith_lambda(cos_i, alpha)) * 4.0 * cos_i)


def sample_visible_normal(wi: np.ndarray, alpha: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Microfacet normals in proportion to their visible area, from uniform numbers: Dupuy & Benyoub 2023.

    u and 1 - u give normals that mirror each other in the plane of `wi` and z, if `wi` is in the plane of x and z.
    """
    scale = np.stack(np.broadcast_arrays(alpha, alpha, 1.0), -1)
    stretched = wi * scale
    stretched = stretched / np.linalg.norm(stretched, axis=-1, keepdims=True)
    z = (1.0 - v) * (1.0 + stretched[..., 2]) - stretched[..., 2]
    sine, phi = np.sqrt(np.maximum(1.0 - z**2, 0.0)), 2.0 * np.pi * u
    h = (stretched + np.stack([sine * np.cos(phi), sine * np.sin(phi), z], -1)) * scale
    return h / np.linalg.norm(h, axis=-1, keepdims=True)


def reflect(wi: np.ndarray, h: np.ndarray) -> np.ndarray:
    return 2.0 * (wi * h).sum(-1, keepdims=True) * h - wi


def direction(cosine: np.ndarray) -> np.ndarray:
    """(…,3) with that cosine to the normal, in the plane of x and z."""
    cosine = np.asarray(cosine, np.float64)
    return np.stack([np.sqrt(1.0 - cosine**2), np.zeros_like(cosine), cosine], -1)


def f0_from_ior(eta: np.ndarray) -> np.ndarray:
    return ((eta - 1.0) / (eta + 1.0)) ** 2


def fresnel_dielectric(cosine: np.ndarray, eta: np.ndarray) -> np.ndarray:
    """Reflectance for unpolarized light. `eta`: IOR below the surface over that above."""
    square = eta**2 - 1.0 + cosine**2
    g = np.sqrt(np.maximum(square, 0.0))
    a, b = (g - cosine) / (g + cosine), (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0)
    return np.where(square > 0.0, 0.5 * a**2 * (1.0 + b**2), 1.0)


def dielectric_shape(cosine: np.ndarray, eta: np.ndarray) -> np.ndarray:
    """The position of the dielectric's reflectance between those at normal (0) and grazing incidence (1)."""
    f0 = f0_from_ior(eta)
    return np.clip((fresnel_dielectric(cosine, eta) - f0) / (1.0 - f0), 0.0, 1.0)


def fresnel_f82(cosine: np.ndarray, f0: np.ndarray, tint: np.ndarray) -> np.ndarray:
    """Schlick's reflectance, multiplied by `tint` at a cosine of 1/7: Kutz, Hašan & Edmondson 2021."""
    schlick = lambda c: f0 + (1.0 - f0) * (1.0 - c) ** 5  # noqa: E731
    dip = schlick(1.0 / 7.0) * (1.0 - tint) * 7.0 / (6.0 / 7.0) ** 6
    return np.clip(schlick(cosine) - dip * cosine * (1.0 - cosine) ** 6, 0.0, 1.0)
