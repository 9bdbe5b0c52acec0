# SPDX-License-Identifier: GPL-3.0-or-later
"""A map of all directions as a texture: its mip levels lie above it, beside one another."""

import numpy as np


def with_mip_levels(radiance: np.ndarray) -> np.ndarray:
    """(3 H / 2,W,4) float16 of a map (H,W,3): the level k > 0 begins at row H and column W - 2 W / 2^k."""
    height, width = radiance.shape[:2]
    texels = np.zeros((height + max(height // 2, 1), width, 4), np.float16)
    level, column = radiance, 0
    texels[:height, :, :3] = np.minimum(level, np.finfo(np.float16).max)
    while max(level.shape[:2]) > 1:
        level = halved(level)
        rows, columns = level.shape[:2]
        texels[height : height + rows, column : column + columns, :3] = np.minimum(level, np.finfo(np.float16).max)
        column += columns
    return texels


def halved(level: np.ndarray) -> np.ndarray:
    """The next mip level: means of two rows and of two columns, where there are as many."""
    rows, columns = (size // 2 * 2 for size in level.shape[:2])
    if rows:
        level = 0.5 * (level[0:rows:2] + level[1:rows:2])
    if columns:
        level = 0.5 * (level[:, 0:columns:2] + level[:, 1:columns:2])
    return level
