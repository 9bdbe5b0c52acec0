# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of lights: what their emission is multiplied by, over areas and across the cones of spots."""

from dataclasses import dataclass

import numpy as np

from .arrays import Arrays, array


@dataclass(frozen=True, eq=False)
class LightImage(Arrays):
    """Linear colours, bottom row first, the largest value of which is 1.

    They cover the rectangle around an area, whose sides its axes are; or the square around a spot's circular cone, in
    the space of its axes.
    """

    colors: np.ndarray = array("float32 H W 3", max_abs=1.0, is_signed=False)
    repeat: bool = True  # beyond the texels at the edges are those at the opposite edges, else the same ones


def resampled(colors: np.ndarray, height: int, width: int) -> np.ndarray:
    """(height,width,C) float32: means of colours (H,W,C) over the areas of the new texels."""
    for axis, count in enumerate((height, width)):
        sums = np.cumsum(colors, axis, np.float64)
        sums = np.concatenate([np.zeros_like(sums.take([0], axis)), sums], axis)
        ends = np.linspace(0.0, colors.shape[axis], count + 1)
        below = np.minimum(ends.astype(int), colors.shape[axis] - 1)
        part = (ends - below).reshape([-1, 1, 1] if axis == 0 else [1, -1, 1])
        at_ends = (1.0 - part) * sums.take(below, axis) + part * sums.take(below + 1, axis)
        colors = np.diff(at_ends, axis=axis) * (count / colors.shape[axis])
    return colors.astype(np.float32)
