# SPDX-License-Identifier: GPL-3.0-or-later
"""What can stand between two boxes: whatever meets a box that moves and grows from the one to the other.

At time t, from 0 to 1, each of its six sides is that part of the way. So it meets a box while six numbers that change
evenly are not positive: from when to when is found as a ray finds how it passes through a box (compare Haines & Wallace
1994, whose shafts have the same sides). Boxes lie along the axes and are (2,3,…): lowest and highest corners.
"""

import numpy as np


def meets_shaft(boxes: np.ndarray, ones: np.ndarray, others: np.ndarray) -> np.ndarray:
    """(N,K) bool: which boxes (2,3,N) a line from one of ones (2,3,K) to its own of others (2,3,K) can meet."""
    enter, leave = np.zeros((boxes.shape[2], ones.shape[2])), np.ones((boxes.shape[2], ones.shape[2]))
    for axis in range(3):
        low, high = boxes[:, axis, :, None]
        for first, last in (
            (ones[0, axis] - high, others[0, axis] - high),
            (low - ones[1, axis], low - others[1, axis]),
        ):
            with np.errstate(divide="ignore", invalid="ignore"):
                crossing = first / (first - last)
            enter = np.where(first > 0.0, np.where(last > 0.0, 2.0, np.maximum(enter, crossing)), enter)
            leave = np.where((first <= 0.0) & (last > 0.0), np.minimum(leave, crossing), leave)
    return enter <= leave
