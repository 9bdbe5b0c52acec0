# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounding boxes of instances, from which the top-level BVH is built, and inverses of their matrices."""

import numpy as np

from ...parallel import parallel_map
from .bvh import quantize_boxes, scale_of

#: Minimum length of an instance's shortest axis relative to its longest, to which flat matrices are regularized before
#: they are inverted.
MIN_AXIS_RATIO = 1e-6

#: Instances of at most this volume, relative to the cube of their size, count as flat.
FLAT_VOLUME = 1e-4

#: Instances whose boxes are computed at a time, so that they stay in the processor's cache.
INSTANCES_AT_A_TIME = 1 << 9


def on_grid(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centre (3,) and scale (3,) of the smallest grid that contains boxes (N,3); the boxes (2,3,N) in its planes."""
    centre = (low.min(0) + high.max(0)) / 2.0
    scale = scale_of(np.maximum(high - centre, centre - low).max(0))
    return centre, scale, quantize_boxes(np.stack([((corner - centre) * scale).T for corner in (low, high)]))


def instance_bounds(
    linear: np.ndarray, offsets: np.ndarray, mesh: np.ndarray, centres: np.ndarray, half_sizes: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Low and high corners (I,3) float32 of the bounding boxes of instances.

    Their transforms are (I,3,3) and (I,3). `mesh` (I,) are indices of M meshes, whose B boxes have centres and half
    sizes (3,M,B).
    """
    low, high = (np.empty((len(mesh), 3)) for _ in range(2))

    def fill(first: int) -> None:
        chunk = slice(first, first + INSTANCES_AT_A_TIME)
        box_centres, box_half_sizes = (by_mesh[:, mesh[chunk]] for by_mesh in (centres, half_sizes))
        for axis in range(3):
            row = linear[chunk, axis, :, None]
            centre = sum(row[:, k] * box_centres[k] for k in range(3)) + offsets[chunk, axis, None]
            half = sum(np.abs(row[:, k]) * box_half_sizes[k] for k in range(3))
            low[chunk, axis], high[chunk, axis] = (centre - half).min(1), (centre + half).max(1)

    parallel_map(fill, range(0, len(mesh), INSTANCES_AT_A_TIME), centres.shape[2] * len(mesh))
    rounding = 1e-6 * (np.abs(low) + np.abs(high))
    return (low - rounding).astype(np.float32), (high + rounding).astype(np.float32)


def inverse_of(linear: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """(I,3,4): the inverses of matrices (I,3,3) and offsets (I,3), singular ones regularized."""
    a, b, c = np.ascontiguousarray(linear.transpose(1, 2, 0))
    columns = np.stack([np.cross(*pair, axis=0) for pair in ((b, c), (c, a), (a, b))])
    volume = (a * columns[0]).sum(0)
    is_flat = np.abs(volume) <= FLAT_VOLUME * (linear * linear).sum((1, 2)) ** 1.5
    inverse = (columns / np.where(is_flat, 1.0, volume)).transpose(2, 1, 0)
    inverse[is_flat] = inverse_of_flat(linear[is_flat])
    return np.concatenate([inverse, -np.einsum("nij,nj->ni", inverse, offsets)[:, :, None]], 2)


def inverse_of_flat(linear: np.ndarray) -> np.ndarray:
    """(I,3,3): inverses of matrices (I,3,3) whose shortest axes are lengthened to MIN_AXIS_RATIO of the longest."""
    u, scales, v = np.linalg.svd(linear)
    scales = np.maximum(scales, np.maximum(MIN_AXIS_RATIO * scales[:, :1], np.finfo(np.float32).tiny))
    return np.einsum("nji,nj,nkj->nik", v, 1.0 / scales, u)
