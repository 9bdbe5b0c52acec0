# SPDX-License-Identifier: GPL-3.0-or-later
"""The sky of Hosek and Wilkie, "An Analytic Model for Full Spectral Sky-Dome Radiance", SIGGRAPH 2012.

hosek_wilkie.npz has their coefficients for CIE XYZ, version 1.4a, by albedo 0 and 1, turbidity 1 … 10 and the six
control points of a Bézier curve over the sun's elevation: `shape` (2,10,6,3,9) and `scale` (2,10,6,3). Their licence is
beside it.
"""

from functools import cache
from math import comb
from pathlib import Path

import numpy as np

from . import preetham
from .parameters import Sky
from .preetham import MIN_COSINE

FILE = Path(__file__).with_name("hosek_wilkie.npz")
#: Cycles' factor of the model's radiance.
BRIGHTNESS = 2.0 * np.pi / 683.0


@cache
def _dataset() -> tuple[np.ndarray, np.ndarray]:
    with np.load(FILE) as file:
        return file["shape"], file["scale"]


def sun_of(sky: Sky) -> np.ndarray:
    """(3,) unit vector to the sun, which the model has no lower than at the horizon."""
    east, north, up = preetham.sun_of(sky)
    if up >= 0.0:
        return np.array([east, north, up])
    azimuth = np.arctan2(east, north)
    return np.array([np.sin(azimuth), np.cos(azimuth), 0.0])


def xyz(sky: Sky, cos_zenith: np.ndarray, cos_sun: np.ndarray) -> np.ndarray:
    """(…,3) CIE XYZ where the cosines of the angles to the zenith and to the sun are these (…)."""
    weights = _weights(sky)
    shape, scale = (np.tensordot(weights, data, 3) for data in _dataset())
    cos_zenith = np.maximum(cos_zenith, MIN_COSINE)
    angle = np.arccos(np.clip(cos_sun, -1.0, 1.0))
    squared = cos_sun * cos_sun
    channels = []
    for (a, b, c, d, e, f, g, h, i), factor in zip(shape, scale * BRIGHTNESS, strict=True):
        spread = 1.0 + i * i - 2.0 * i * cos_sun
        glow = c + d * np.exp(e * angle) + f * squared + g * (1.0 + squared) / (spread * np.sqrt(spread))
        horizon = factor * (1.0 + a * np.exp(b / (cos_zenith + 0.01)))
        channels.append(horizon * (glow + h * np.sqrt(cos_zenith)))
    return np.stack(channels, -1)


def _weights(sky: Sky) -> np.ndarray:
    """(2,10,6): weights of the dataset's albedos, turbidities and control points."""
    elevation = np.arcsin(sun_of(sky)[2])
    t = np.cbrt(elevation / (0.5 * np.pi))
    points = np.array([comb(5, k) * (1.0 - t) ** (5 - k) * t**k for k in range(6)])
    turbidities = np.maximum(1.0 - np.abs(np.clip(sky.turbidity, 1.0, 10.0) - np.arange(1, 11)), 0.0)
    albedos = np.array([1.0 - sky.ground_albedo, sky.ground_albedo])
    return albedos[:, None, None] * turbidities[:, None] * points
