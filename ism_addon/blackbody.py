# SPDX-License-Identifier: GPL-3.0-or-later
"""The colour of a black body."""

import numpy as np

#: Range of temperatures, K: others have the colour at its ends.
MIN_TEMPERATURE, MAX_TEMPERATURE = 800.0, 12000.0

#: Polynomials of 1000 K / temperature for red, green and blue, fitted to the colours that Blender 4.5 gives to lights
#: of 800 temperatures. The largest error is 0.0024.
COEFFICIENTS = np.array(
    [
        [0.66011, 1.19, 10.908, -18.218, 17.026, -8.917, 1.9535],
        [0.95299, 0.9219, -5.7508, 7.666, -5.6394, 2.2578, -0.36945],
        [2.2633, -7.5187, -23.474, 201.0, -538.64, 678.54, -337.89],
    ]
)
#: Blue is 0 below this temperature, K, and green at the lower end of the range.
BLUE_FROM = 1900.0


def blackbody(temperature: float) -> np.ndarray:
    """(3,) float64 linear Rec.709, of luminance 1: the colour of a black body of this temperature, K."""
    temperature = min(max(temperature, MIN_TEMPERATURE), MAX_TEMPERATURE)
    rgb = COEFFICIENTS @ (1000.0 / temperature) ** np.arange(COEFFICIENTS.shape[1])
    return np.maximum(rgb, 0.0) * (1.0, 1.0, float(temperature > BLUE_FROM))
