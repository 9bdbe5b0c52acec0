# SPDX-License-Identifier: GPL-3.0-or-later
"""Which instances can be in the picture: the box around each against the planes of the view (Clark 1976)."""

import numpy as np


def in_view(half_sizes: np.ndarray, clip_from_centre: np.ndarray, margin: float) -> np.ndarray:
    """(I,) bool: whether any of a box may be seen, by half its size (I,3) and matrices (I,4,4) about its centre.

    `margin` is beyond the picture, as a part of half of it.
    """
    aside, ahead = clip_from_centre[:, :3], (1.0 + margin) * clip_from_centre[:, 3:]
    planes = np.concatenate([ahead - aside, ahead + aside], 1)
    farthest = planes[..., 3] + np.einsum("npj,nj->np", np.abs(planes[..., :3]), half_sizes)
    return (farthest >= 0.0).all(1)


def runs(chosen: np.ndarray, kinds: np.ndarray) -> list[tuple[int, int]]:
    """First and count of each row of neighbours of one kind (N,) int that are all chosen (N,) bool; -1 is no kind."""
    numbers = np.concatenate([[-1], np.where(chosen, kinds, -1), [-1]])
    edges = np.flatnonzero(np.diff(numbers))
    begins = numbers[edges[:-1] + 1] >= 0
    return list(zip(edges[:-1][begins].tolist(), np.diff(edges)[begins].tolist(), strict=True))
