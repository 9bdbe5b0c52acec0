# SPDX-License-Identifier: GPL-3.0-or-later
"""How large a number may be, so that float32 still holds its square after a matrix has moved it."""

import numpy as np

#: m, or W/(sr m²). Blender lets users type up to 3e38.
FARTHEST = 1e9


def within(values: np.ndarray) -> np.ndarray:
    """Element by element: a number, and not beyond FARTHEST."""
    return np.abs(values) <= FARTHEST
