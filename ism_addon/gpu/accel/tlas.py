# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tree over the instances is built from: their boxes, and the inverses of their matrices."""

import numpy as np

from ...parallel import parallel_map
from .bvh import quantize_boxes, scale_of

#: An axis that an instance squeezes to less than this part of its longest is kept as long: flat things have two sides.
MIN_AXIS_RATIO = 1e-6

#: What fills less than this of its longest axis cubed is looked at for such axes.
FLAT_VOLUME = 1e-4

#: Instances that are bounded at a time: their boxes stay in a processor's cache.
INSTANCES_AT_A_TIME = 1 << 9


def on_grid(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The middle (3,) and the scale (3,) of the grid that just holds boxes (N,3), and them on it (2,3,N) in planes."""
    middle = (low.min(0) + high.max(0)) / 2.0
    scale = scale_of(np.maximum(high - middle, middle - low).max(0))
    return middle, scale, quantize_boxes(np.stack([((corner - middle) * scale).T for corner in (low, high)]))


def instance_bounds(
    linear: np.ndarray, offsets: np.ndarray, mesh: np.ndarray, middles: np.ndarray, halves: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Low and high corners (I,3) float32 of instances, whose mesh (I,) has boxes of middles and halves (3,M,B).

    They are moved by (I,3,3) and (I,3). Boxes lie side by side: numpy is slow along short axes.
    """
    low, high = (np.empty((len(mesh), 3)) for _ in range(2))

    def fill(first: int) -> None:
        part = slice(first, first + INSTANCES_AT_A_TIME)
        own_middles, own_halves = (of_meshes[:, mesh[part]] for of_meshes in (middles, halves))
        for axis in range(3):
            row = linear[part, axis, :, None]
            middle = sum(row[:, k] * own_middles[k] for k in range(3)) + offsets[part, axis, None]
            half = sum(np.abs(row[:, k]) * own_halves[k] for k in range(3))
            low[part, axis], high[part, axis] = (middle - half).min(1), (middle + half).max(1)

    parallel_map(fill, range(0, len(mesh), INSTANCES_AT_A_TIME), middles.shape[2] * len(mesh))
    slack = 1e-6 * (np.abs(low) + np.abs(high))
    return (low - slack).astype(np.float32), (high + slack).astype(np.float32)


def inverse_of(linear: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """(I,3,4): the inverses of matrices (I,3,3) and offsets (I,3); those that flatten leave a little thickness."""
    a, b, c = np.ascontiguousarray(linear.transpose(1, 2, 0))
    columns = np.stack([np.cross(*pair, axis=0) for pair in ((b, c), (c, a), (a, b))])
    volume = (a * columns[0]).sum(0)
    flat = np.abs(volume) <= FLAT_VOLUME * (linear * linear).sum((1, 2)) ** 1.5
    inverse = (columns / np.where(flat, 1.0, volume)).transpose(2, 1, 0)
    inverse[flat] = inverse_of_flat(linear[flat])
    return np.concatenate([inverse, -np.einsum("nij,nj->ni", inverse, offsets)[:, :, None]], 2)


def inverse_of_flat(linear: np.ndarray) -> np.ndarray:
    """(I,3,3): the inverses of (I,3,3), whose shortest axes count as longer."""
    u, scales, v = np.linalg.svd(linear)
    scales = np.maximum(scales, np.maximum(MIN_AXIS_RATIO * scales[:, :1], np.finfo(np.float32).tiny))
    return np.einsum("nji,nj,nkj->nik", v, 1.0 / scales, u)
