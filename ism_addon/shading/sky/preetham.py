# SPDX-License-Identifier: GPL-3.0-or-later
"""The sky of Preetham, Shirley and Smits, "A Practical Analytic Model for Daylight", SIGGRAPH 1999, appendix A.2."""

import numpy as np

from .parameters import Sky

#: Coefficients A … E of Perez' function for the luminance and the chromaticities x and y: turbidity's factor, summand.
PEREZ = np.array(
    [
        [[0.1787, -1.4630], [-0.3554, 0.4275], [-0.0227, 5.3251], [0.1206, -2.5771], [-0.0670, 0.3703]],
        [[-0.0193, -0.2592], [-0.0665, 0.0008], [-0.0004, 0.2125], [-0.0641, -0.8989], [-0.0033, 0.0452]],
        [[-0.0167, -0.2608], [-0.0950, 0.0092], [-0.0079, 0.2102], [-0.0441, -1.6537], [-0.0109, 0.0529]],
    ]
)
#: Chromaticities at the zenith: rows are powers 2 … 0 of turbidity, columns powers 3 … 0 of the sun's zenith angle.
ZENITH_X = np.array(
    [
        [0.00166, -0.00375, 0.00209, 0.0],
        [-0.02903, 0.06377, -0.03202, 0.00394],
        [0.11693, -0.21196, 0.06052, 0.25886],
    ]
)
ZENITH_Y = np.array(
    [
        [0.00275, -0.00610, 0.00317, 0.0],
        [-0.04214, 0.08970, -0.04153, 0.00516],
        [0.15346, -0.26756, 0.06670, 0.26688],
    ]
)
#: Cycles' factor of the luminance, from kcd/m².
BRIGHTNESS = 0.06
#: Least cosine of the zenith angle: below the horizon the sky is as just above it.
MIN_COSINE = np.sin(0.001)


def sun_of(sky: Sky) -> np.ndarray:
    """(3,) unit vector to the sun; the zenith if the setting has no direction."""
    length = np.linalg.norm(sky.sun_direction)
    return np.divide(sky.sun_direction, length) if length else np.array([0.0, 0.0, 1.0])


def xyz(sky: Sky, cos_zenith: np.ndarray, cos_sun: np.ndarray) -> np.ndarray:
    """(…,3) CIE XYZ where the cosines of the angles to the zenith and to the sun are these (…)."""
    coefficients = PEREZ @ (sky.turbidity, 1.0)
    zenith_angle = np.arccos(sun_of(sky)[2])
    at_zenith = _zenith(sky.turbidity, zenith_angle)
    cos_zenith = np.maximum(cos_zenith, MIN_COSINE)
    angle = np.arccos(np.clip(cos_sun, -1.0, 1.0))
    luminance, x, y = (
        value / _perez(row, 1.0, zenith_angle, np.cos(zenith_angle)) * _perez(row, cos_zenith, angle, cos_sun)
        for value, row in zip(at_zenith, coefficients, strict=True)
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = np.where(y == 0.0, 0.0, luminance / y)
    return np.stack([x * scale, luminance, (1.0 - x - y) * scale], -1)


def _zenith(turbidity: float, angle: float) -> tuple[float, float, float]:
    """Luminance and chromaticities at the zenith; the angle is the sun's, rad."""
    chi = (4.0 / 9.0 - turbidity / 120.0) * (np.pi - 2.0 * angle)
    luminance = (4.0453 * turbidity - 4.9710) * np.tan(chi) - 0.2155 * turbidity + 2.4192
    powers = turbidity ** np.arange(2, -1, -1), angle ** np.arange(3, -1, -1)
    return BRIGHTNESS * luminance, powers[0] @ ZENITH_X @ powers[1], powers[0] @ ZENITH_Y @ powers[1]


def _perez(
    coefficients: np.ndarray, cos_zenith: float | np.ndarray, angle: float | np.ndarray, cos_sun: float | np.ndarray
) -> np.ndarray:
    """Perez' function. The angle is the one to the sun, rad."""
    a, b, c, d, e = coefficients
    return (1.0 + a * np.exp(b / cos_zenith)) * (1.0 + c * np.exp(d * angle) + e * cos_sun * cos_sun)
