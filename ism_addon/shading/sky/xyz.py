# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of skies from CIE XYZ."""

import numpy as np

from ...color import REC709, xyz_from

RGB_FROM_XYZ = np.linalg.inv(xyz_from(REC709))


def rgb_from_xyz(xyz: np.ndarray) -> np.ndarray:
    """(…,3) linear Rec.709, negative outside of its gamut, of the same type."""
    return xyz @ RGB_FROM_XYZ.T.astype(xyz.dtype)


def without_negative(rgb: np.ndarray) -> np.ndarray:
    """(…,3) float32: 0 for what is negative, as in Cycles, or not a number."""
    return np.fmax(rgb, 0.0, dtype=np.float32, casting="same_kind")
