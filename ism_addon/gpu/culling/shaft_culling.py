# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaft culling: which boxes may occlude lines from one box to another.

The shaft between two boxes is swept by their linear interpolation, t from 0 to 1. It overlaps a box while six linear
functions of t are not positive; this interval is computed as in the slab test of rays against boxes (compare Haines &
Wallace 1994, whose shafts have the same sides). Boxes are aligned to the axes and are (2,3,…): low and high corners.
"""

import numpy as np


def meets_shaft(boxes: np.ndarray, starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """(N,K) bool: whether boxes (2,3,N) overlap shafts from boxes `starts` (2,3,K) to boxes `ends` (2,3,K)."""
    enter, leave = np.zeros((boxes.shape[2], starts.shape[2])), np.ones((boxes.shape[2], starts.shape[2]))
    for axis in range(3):
        low, high = boxes[:, axis, :, None]
        for first, last in (
            (starts[0, axis] - high, ends[0, axis] - high),
            (low - starts[1, axis], low - ends[1, axis]),
        ):
            with np.errstate(divide="ignore", invalid="ignore"):
                crossing = first / (first - last)
            enter = np.where(first > 0.0, np.where(last > 0.0, 2.0, np.maximum(enter, crossing)), enter)
            leave = np.where((first <= 0.0) & (last > 0.0), np.minimum(leave, crossing), leave)
    return enter <= leave
