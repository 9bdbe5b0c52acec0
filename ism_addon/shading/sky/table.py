# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of skies in Cycles' layout, and their interpolation.

A table has ROWS rows of COLUMNS texels. Rows go from the nadir to the zenith and are denser at the horizon: the
elevation is ± π/2 l², l from -1 to 1. Columns are azimuths, clockwise from opposite to the sun. The right half of a row
mirrors the left one.
"""

import numpy as np

ROWS, COLUMNS = 256, 512


def row_at(elevation: np.ndarray) -> np.ndarray:
    """Rows, counted from the first texel's centre, of elevations, rad."""
    level = np.copysign(np.sqrt(np.abs(elevation) / (0.5 * np.pi)), elevation)
    return 0.5 * ROWS * (1.0 + level) - 0.5


def column_at(azimuth: np.ndarray) -> np.ndarray:
    """Columns, counted from the first texel's centre, of azimuths clockwise from opposite to the sun, rad."""
    return COLUMNS * (azimuth / (2.0 * np.pi) % 1.0) - 0.5


def mirrored(half: np.ndarray) -> np.ndarray:
    """(ROWS,COLUMNS,3): the table whose left half this is."""
    return np.concatenate([half, half[:, ::-1]], 1)


def neighbours(position: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Indices of the texels before and after positions in `count` texels, and the weights float32 of the latter."""
    position = np.clip(position, 0.0, count - 1.0)
    index = position.astype(np.int32)
    return index, np.minimum(index + 1, count - 1), (position - index).astype(np.float32)


def interpolated(first: np.ndarray, second: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Linear interpolation; the arrays may be changed."""
    second -= first
    second *= weight
    second += first
    return second


def sampled(table: np.ndarray, row: np.ndarray, column: np.ndarray) -> np.ndarray:
    """(…,K) bilinear values of a table (R,C,K) at rows and columns (…)."""
    y0, y1, v = neighbours(row, table.shape[0])
    x0, x1, u = neighbours(column, table.shape[1])
    texels, y0, y1 = table.reshape(-1, table.shape[2]), y0 * table.shape[1], y1 * table.shape[1]
    below, above = (interpolated(texels[y + x0], texels[y + x1], u[..., None]) for y in (y0, y1))
    return interpolated(below, above, v[..., None])


def sampled_grid(table: np.ndarray, row: np.ndarray, column: np.ndarray) -> np.ndarray:
    """(H,W,K) the same at all pairs of rows (H,) and columns (W,)."""
    y0, y1, v = neighbours(row, table.shape[0])
    lines = interpolated(table[y0], table[y1], v[:, None, None])
    x0, x1, u = neighbours(column, table.shape[1])
    return interpolated(lines[:, x0], lines[:, x1], u[:, None])


def nodes(count: int) -> np.ndarray:
    """(count,) azimuths within 0 … π, rad, from which others are interpolated."""
    return np.pi * (np.arange(count) + 0.5) / count


def from_nodes(azimuth: np.ndarray, count: int) -> np.ndarray:
    """(A,count) float32: values at azimuths (A,), rad, from those at the nodes: a series of cosines, which converges
    fast for light before its phase function."""
    order = np.arange(1, count)
    products = np.cos(np.outer(azimuth, order)) @ np.cos(np.outer(order, nodes(count)))
    return ((1.0 + 2.0 * products) / count).astype(np.float32)
