# SPDX-License-Identifier: GPL-3.0-or-later
"""View frustum culling of instances by their bounding boxes (Clark 1976)."""

import numpy as np


def in_view(half_sizes: np.ndarray, clip_from_centre: np.ndarray, margin: float) -> np.ndarray:
    """(I,) bool: whether a box may be in view, by half its size (I,3) and matrices (I,4,4) about its centre.

    The view is enlarged by `margin`, in clip space.
    """
    xyz, w = clip_from_centre[:, :3], (1.0 + margin) * clip_from_centre[:, 3:]
    planes = np.concatenate([w - xyz, w + xyz], 1)
    farthest = planes[..., 3] + np.einsum("npj,nj->np", np.abs(planes[..., :3]), half_sizes)
    return (farthest >= 0.0).all(1)


def runs(chosen: np.ndarray, kinds: np.ndarray) -> list[tuple[int, int]]:
    """First and count of each run of neighbours of the same kind (N,) int, not -1, that are all chosen (N,) bool."""
    numbers = np.concatenate([[-1], np.where(chosen, kinds, -1), [-1]])
    edges = np.flatnonzero(np.diff(numbers))
    begins = numbers[edges[:-1] + 1] >= 0
    return list(zip(edges[:-1][begins].tolist(), np.diff(edges)[begins].tolist(), strict=True))
