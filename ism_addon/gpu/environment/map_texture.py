# SPDX-License-Identifier: GPL-3.0-or-later
"""A map of all directions as a texture: its mip levels lie above it, beside one another."""

import numpy as np

from ...half_floats import MAX_HALF, halves
from ..buffers.mip_levels import halved


def with_mip_levels(radiance: np.ndarray, unit: float) -> np.ndarray:
    """(3 H / 2,W,4) float16 of a map (H,W,3), in this unit: level k > 0 begins at row H and column W - 2 W / 2^k."""
    height, width = radiance.shape[:2]
    texels = np.empty((height + max(height // 2, 1), width, 4), np.float16)
    level, column = np.empty((height, width, 4), np.float32), 0
    for channel in range(3):  # numpy divides one of all texels at once, but three channels texel by texel
        np.divide(radiance[..., channel], np.float32(unit), out=level[..., channel])
    level[..., 3] = 0.0
    halves(np.minimum(level, np.float32(MAX_HALF), out=level), texels[:height])
    texels[height:] = 0.0
    while max(level.shape[:2]) > 1:
        level = halved(level)
        rows, columns = level.shape[:2]
        texels[height : height + rows, column : column + columns] = halves(level)
        column += columns
    return texels
