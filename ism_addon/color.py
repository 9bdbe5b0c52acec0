# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear light, its primaries, and its encoding in screens and image files (sRGB, IEC 61966-2-1)."""

import numpy as np

#: Blender's name of the working space of nearly all files.
REC709 = "Linear Rec.709"


def linear_from_srgb(encoded: np.ndarray) -> np.ndarray:
    """Linear light of encoded values in [0,1]."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def srgb_from_linear(linear: np.ndarray) -> np.ndarray:
    """Encoded values of linear light in [0,1]."""
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * np.maximum(linear, 0.0) ** (1.0 / 2.4) - 0.055)


#: Chromaticities (x,y) of the red, green and blue primaries and the white of linear spaces, by Blender's names.
PRIMARIES = {
    REC709: ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06), (0.3127, 0.3290)),
    "Linear Rec.2020": ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046), (0.3127, 0.3290)),
    "ACEScg": ((0.713, 0.293), (0.165, 0.830), (0.128, 0.044), (0.32168, 0.33767)),
}

#: Cone responses from XYZ, for chromatic adaptation (Lam 1985, as in ICC profiles).
BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])


def xyz_from(space: str) -> np.ndarray:
    """(3,3): CIE XYZ from linear light in a space of PRIMARIES; the second row is its luminance."""
    *primaries, white = (np.array([x, y, 1.0 - x - y]) / y for x, y in PRIMARIES[space])
    columns = np.stack(primaries, 1)
    return columns * np.linalg.solve(columns, white)


def between_spaces(to: str, source: str) -> np.ndarray:
    """(3,3): linear light in space `to` from that in `source`, both of PRIMARIES, with chromatic adaptation."""
    cones = [BRADFORD @ xyz_from(space) @ np.ones(3) for space in (to, source)]
    adapted = np.linalg.solve(BRADFORD, np.diag(cones[0] / cones[1]) @ BRADFORD)
    return np.linalg.solve(xyz_from(to), adapted @ xyz_from(source))


def luminance(space: str) -> np.ndarray:
    """(3,): luminances of a space's primaries, rounded to four digits; a color's luminance is color @ these."""
    return xyz_from(space)[1].round(4)


#: Range of temperatures, K: others have the colour at its ends.
MIN_TEMPERATURE, MAX_TEMPERATURE = 800.0, 12000.0

#: Polynomials of 1000 K / temperature for red, green and blue, fitted to the colours that Blender 4.5 gives to lights
#: of 800 temperatures. The largest error is 0.0024.
BLACKBODY_COEFFICIENTS = np.array(
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
    rgb = BLACKBODY_COEFFICIENTS @ (1000.0 / temperature) ** np.arange(BLACKBODY_COEFFICIENTS.shape[1])
    return np.maximum(rgb, 0.0) * (1.0, 1.0, float(temperature > BLUE_FROM))
