# SPDX-License-Identifier: GPL-3.0-or-later
"""How large a number may be, so that float32 still holds its square after a matrix has moved it."""

import numpy as np

#: m. Blender lets users type up to 3e38.
FARTHEST = 1e9

#: W/(sr m²).
BRIGHTEST = 1e15


def within(values: np.ndarray, most: float = FARTHEST) -> np.ndarray:
    """Element by element: a number, and none beyond what float32 can deal with."""
    return np.abs(values) <= most
