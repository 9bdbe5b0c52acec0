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


def runs(chosen: np.ndarray) -> list[tuple[int, int]]:
    """First and count of each row of neighbours that are all chosen (N,)."""
    edges = np.flatnonzero(np.diff(chosen, prepend=False, append=False))
    return [(int(first), int(end - first)) for first, end in edges.reshape(-1, 2)]
