# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear light and how screens and image files encode it (sRGB, IEC 61966-2-1)."""

import numpy as np

#: How bright Rec.709's primaries look: luminance = color @ LUMINANCE.
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def linear_from_srgb(encoded: np.ndarray) -> np.ndarray:
    """Linear light of encoded values in [0,1]."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def srgb_from_linear(linear: np.ndarray) -> np.ndarray:
    """Encoded values of linear light in [0,1]."""
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * np.maximum(linear, 0.0) ** (1.0 / 2.4) - 0.055)
