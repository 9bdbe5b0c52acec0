# SPDX-License-Identifier: GPL-3.0-or-later
"""How the emission of lights depends on the direction, in float64, as in Cycles."""

import numpy as np

from ism_addon.scene import Lights


def spread_factor(spread: float, cosine: np.ndarray) -> np.ndarray:
    """Factor of a light's radiance at angles of `cosine` to its normal. It leaves the light's power unchanged."""
    half = max(spread, np.radians(1.0)) / 2.0
    if half > np.pi / 2.0 - 1e-4:
        return np.ones_like(cosine)
    tangent = np.sqrt(np.maximum(1.0 - cosine**2, 0.0)) / np.maximum(cosine, 1e-20)
    return np.maximum(np.tan(half) - tangent, 0.0) / (np.tan(half) - half)


def spot_attenuation(directions: np.ndarray, lights: Lights, light: int) -> np.ndarray:
    """Factor of a spot's intensity in directions (…,3): a smoothstep of the cosine in the scaled space."""
    axes = [lights.axis_u[light], lights.axis_v[light], lights.normal[light]]
    local = np.stack([directions @ axis / (axis @ axis) for axis in axes], -1)
    edge = np.cos(lights.spread[light] / 2.0)
    x = (local[..., 2] / np.linalg.norm(local, axis=-1) - edge) / max((1.0 - edge) * lights.blend[light], 1e-9)
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)
