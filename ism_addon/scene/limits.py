# SPDX-License-Identifier: GPL-3.0-or-later
"""Limits of a scene's values, so that float32 holds their squares after a transform.

Blender's data beyond the limits is left out with a warning; a snapshot with such values is invalid.
"""

import numpy as np

#: Limit of distances, m, and of other values, such as matrix elements and colours. Blender allows 3e38.
MAX_DISTANCE = 1e9

#: Limit of the emission of lights and materials: radiance, W/(sr m²), intensity, W/sr, or irradiance, W/m².
MAX_EMISSION = 1e15

#: Limit of the factor of a light's size for its shadow.
MAX_SOFTNESS = 100.0

#: Minimum scale of an instance.
MIN_SCALE = 1e-15

#: Vectors count as coplanar if their volume is below this fraction of the product of their lengths.
PLANAR_VOLUME = 1e-9


def is_within(values: np.ndarray, limit: float = MAX_DISTANCE) -> np.ndarray:
    """For each element, whether it is a number and its absolute value within the limit."""
    return np.abs(values) <= limit


def is_invertible(linear: np.ndarray) -> np.ndarray:
    """(N,) bool: whether matrices (N,3,3) of float32 precision are invertible."""
    lengths = np.linalg.norm(linear, axis=1)
    return (lengths >= MIN_SCALE).all(1) & (np.abs(np.linalg.det(linear)) > PLANAR_VOLUME * lengths.prod(1))


def spans_plane(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(N,) bool: whether vectors (N,3) span a plane, with the same tolerance."""
    size = np.linalg.norm(u, axis=1) * np.linalg.norm(v, axis=1)
    return np.linalg.norm(np.cross(u, v), axis=1) > PLANAR_VOLUME * size
