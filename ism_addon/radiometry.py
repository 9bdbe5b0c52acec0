# SPDX-License-Identifier: GPL-3.0-or-later
"""Radiance and irradiance from Blender's watts and metres.

An area light is a one-sided Lambertian emitter. It sends L·cosθ in every direction, so a patch of area A
emits A · ∫ L cosθ dω = A·π·L watts: a light of P watts has the radiance L = P / (π A).

A polygon of radiance L above a receiver's horizon gives, by Stokes' theorem, the irradiance
E = L/2 · Σ_edges angle(v_i, v_i+1) · n·(v_i × v_i+1)/|v_i × v_i+1|   (Lambert 1760; Arvo 1994),
v_i the directions to its corners, n the receiver's normal. The polygon is clipped at the horizon.

An ellipse with the semi-axes u, v about c subtends a cone whose axes are the eigenvectors of
S = u uᵀ + v vᵀ - c cᵀ: with the eigenvalues m a², m b², -m it is x²/a² + y²/b² ≤ z². By symmetry its vector
irradiance is parallel to z, and ∫∫ dx dy / (1 + x² + y²)² over that ellipse is π a b / √((1 + a²)(1 + b²)):
E = L π (n·z) |det(u, v, c)| / √(m q'(m)),  q(x) = det(S + x) = (x + m a²)(x + m b²)(x - m), det S = -det(u, v, c)².
There is no cancellation for small lights. If the horizon cuts the ellipse, Lambert's integral runs along the rim,
(a cos t, b sin t, 1), where it is an arc tangent, and back along the horizon, where it is an angle.

A spread s below 180° weighs the radiance towards the angle θ off the light's normal by
(T - tan θ)⁺ / (T - s/2), T = tan(s/2), as Blender's Cycles does (a softbox's grid); the divisor keeps the watts:
2 ∫ (T - tan θ) cosθ sinθ dθ from 0 to s/2 is T - s/2. In polar coordinates r, φ about the receiver's foot on the
light's plane, in units of its height, n = (n_φ, n_z) in the light's space, that is E = L / (T - s/2) ·
∫∫ (n_z + n_φ r) (T - r)⁺ r / (1 + r²)² dr dφ. The integral over r is elementary, the other one is computed by Gaussian
quadrature: along a polygon's edges inside the cone, by Green's theorem, or over the angles that an ellipse subtends at
the foot.
"""

import numpy as np

from .scene import Lights, LightShape

#: Minimum spread. In Cycles, a light with spread 0 emits parallel light; with this spread it is nearly parallel.
MIN_SPREAD = np.radians(0.1)


def area_light_radiance(power: np.ndarray, area: float) -> np.ndarray:
    """Radiance W/(sr m²) of `power` (3,) W emitted by one side of `area` m²."""
    return np.asarray(power, np.float64) / (np.pi * area)


def point_light_factor(radius: float, normalized: bool) -> float:
    """Intensity, W/sr, by W of a point light of this radius, m.

    A sphere of radiance L has the intensity π r² L, and emits 4 π² r² L watts. Cycles without normalization takes the
    power for π times the radiance.
    """
    if normalized:
        return 0.25 / np.pi
    return radius * radius if radius > 0.0 else 1.0 / np.pi


def sun_light_factor(angle: float, normalized: bool) -> float:
    """Irradiance, W/m², of a surface that faces a sun of this angle, rad, by the sun's strength.

    Cycles without normalization takes the strength for the radiance, if there is an angle.
    """
    return 1.0 if normalized or angle == 0.0 else float(np.pi * np.sin(0.5 * min(angle, np.pi)) ** 2)


def is_perpendicular(axis_u: np.ndarray, axis_v: np.ndarray) -> bool:
    """Whether a light's axes (3,) are at right angles, within the precision of Blender's float32 matrices."""
    return abs(float(axis_u @ axis_v)) <= 1e-5 * float(np.linalg.norm(axis_u) * np.linalg.norm(axis_v))


def plane_normals(lights: Lights) -> np.ndarray:
    """(L,3) unit normals of the planes that the axes span, on the side that emits. Those of sheared lights differ from
    `normal`."""
    normals = np.cross(lights.axis_u, lights.axis_v)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return np.copysign(1.0, np.einsum("nk,nk->n", normals, lights.normal))[:, None] * normals


def light_areas(lights: Lights) -> np.ndarray:
    """(L,) m²: products of the axes' lengths, more than a sheared light has; an ellipse fills pi/4 of its box."""
    box = np.linalg.norm(lights.axis_u, axis=1) * np.linalg.norm(lights.axis_v, axis=1)
    return np.where(lights.shape == LightShape.ELLIPSE, np.pi / 4.0, 1.0) * box


def spread_terms(spread: np.ndarray) -> np.ndarray:
    """(…,2): tan(s/2) and 1/(tan(s/2) - s/2) of Blender's spreads s (…,) rad; (0, 0) where s is 180°."""
    half = np.maximum(np.asarray(spread, np.float64), MIN_SPREAD) / 2.0
    is_full = half >= np.pi / 2.0 - 1e-6
    tangent = np.tan(np.where(is_full, 0.5, half))
    terms = np.stack([tangent, 1.0 / (tangent - np.where(is_full, 0.4, half))], -1)
    return np.where(is_full[..., None], 0.0, terms)
