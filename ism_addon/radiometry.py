# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's watts and metres to radiance and irradiance.

An area light is a one-sided Lambertian emitter. It sends L·cosθ in every direction, so a patch of area A
emits A · ∫ L cosθ dω = A·π·L watts: a light of P watts has the radiance L = P / (π A).

A polygon of radiance L that is wholly above a receiver's horizon gives the irradiance
E = L/2 · Σ_edges angle(v_i, v_i+1) · n·(v_i × v_i+1)/|v_i × v_i+1|   (Lambert 1760; Arvo 1994),
v_i the directions to its corners, n the receiver's normal. What is below the horizon is clipped away.

A spread below 180° weighs the radiance towards the angle a off the light's normal by
(tan(s/2) - tan a)⁺ / (tan(s/2) - s/2), as Blender's Cycles does; the divisor keeps the watts.
"""

import numpy as np

from .scene import Lights, LightShape

#: Corners of the polygon of equal area that stands for an ellipse in the edge sum.
ELLIPSE_CORNERS = 16

#: Spreads are no narrower than this, as in Cycles.
MIN_SPREAD = np.radians(1.0)


def area_light_radiance(power: np.ndarray, area: float) -> np.ndarray:
    """Radiance W/(sr m²) of `power` (3,) W sent out by one side of `area` m²."""
    return np.asarray(power, np.float64) / (np.pi * area)


def light_areas(lights: Lights) -> np.ndarray:
    """(L,) m²: products of the axes' lengths, as in Cycles; an ellipse fills pi/4 of its box."""
    box = np.linalg.norm(lights.axis_u, axis=1) * np.linalg.norm(lights.axis_v, axis=1)
    return np.where(lights.shape == LightShape.ELLIPSE, np.pi / 4.0, 1.0) * box


def spread_terms(spread: np.ndarray) -> np.ndarray:
    """(…,2): tan(s/2) and 1/(tan(s/2) - s/2) of Blender's spreads s (…,) rad; (0, 0) where s is 180°."""
    half = np.maximum(spread, MIN_SPREAD) / 2.0
    wide = half >= np.pi / 2.0 - 1e-6
    tangent = np.tan(np.where(wide, 0.5, half))
    terms = np.stack([tangent, 1.0 / (tangent - np.where(wide, 0.4, half))], -1)
    return np.where(wide[..., None], 0.0, terms)


def ellipse_polygon_scale(corners: int) -> float:
    """Radius of the regular polygon whose area is that of the unit disk."""
    return float(np.sqrt(2.0 * np.pi / (corners * np.sin(2.0 * np.pi / corners))))
