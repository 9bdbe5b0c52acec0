# SPDX-License-Identifier: GPL-3.0-or-later
"""View frustum culling of instances by their bounding boxes (Clark 1976)."""

import numpy as np


def in_view(half_sizes: np.ndarray, clip_from_centre: np.ndarray, margin: float) -> np.ndarray:
    """(I,) bool: whether boxes may be in view. Half sizes are (I,3), matrices (I,4,4) map from their centres.

    The view is enlarged by `margin`, in clip space.
    """
    xyz, w = clip_from_centre[:, :3], (1.0 + margin) * clip_from_centre[:, 3:]
    planes = np.concatenate([w - xyz, w + xyz], 1)
    max_distances = planes[..., 3] + np.einsum("npj,nj->np", np.abs(planes[..., :3]), half_sizes)
    return (max_distances >= 0.0).all(1)


def runs(is_chosen: np.ndarray, values: np.ndarray) -> list[tuple[int, int]]:
    """First index and length of each run of equal values (N,) int, not -1, where `is_chosen` (N,) is true."""
    padded = np.concatenate([[-1], np.where(is_chosen, values, -1), [-1]])
    edges = np.flatnonzero(np.diff(padded))
    is_run = padded[edges[:-1] + 1] >= 0
    return list(zip(edges[:-1][is_run].tolist(), np.diff(edges)[is_run].tolist(), strict=True))
