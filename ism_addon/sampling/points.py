# SPDX-License-Identifier: GPL-3.0-or-later
"""Points on triangles and on lights."""

import numpy as np

from ..parallel import parallel_map
from .dimensions import Dimension, draw

#: Number of points that are computed at a time, so that several cores share the work.
POINTS_AT_A_TIME = 1 << 17


def barycentric(squares: np.ndarray) -> np.ndarray:
    """Uniform barycentric coordinates (N,3) of points (N,2) of the unit square.

    The square's upper half is folded onto the lower one. The report's listing 1 ends in a slip
    (1 - t2 - t3); the third coordinate is 1 - t1 - t2.
    """
    folded = np.where(squares.sum(1, keepdims=True) > 1.0, 1.0 - squares, squares)
    return np.column_stack([folded, 1.0 - folded.sum(1)])


def triangle_areas(corners: np.ndarray) -> np.ndarray:
    """(T,) m² of triangles (T,3,3)."""
    edges = corners[:, 1:] - corners[:, :1]
    return 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)


def proportional_counts(weights: np.ndarray, count: int) -> np.ndarray:
    """(N,) int64 that sum to `count`, each within 1 of `count` times its fraction of the sum of `weights` (N,)."""
    total = weights.sum()
    if total <= 0.0:
        return np.zeros(len(weights), np.int64)
    edges = np.floor(np.cumsum(weights) / total * count + 0.5).astype(np.int64)
    edges[-1] = count
    return np.diff(edges, prepend=0)


def points_on_triangles(corners: np.ndarray, count: int, first: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Triangle indices (count,) and positions (count,3) of a mesh's infinite sequence of points, from `first` on.

    Triangles (T,3,3) are chosen with probability in proportion to their area, points uniformly on each:
    one dimension of the sequence chooses the triangle, two the point on it.
    """
    cumulative = np.cumsum(triangle_areas(corners))

    def points_from(start: int) -> tuple[np.ndarray, np.ndarray]:
        index = np.arange(first + start, first + min(start + POINTS_AT_A_TIME, count))
        random = draw(Dimension.MAP_POINT, point=index)
        chosen = np.searchsorted(cumulative, random[:, 0] * cumulative[-1], side="right")
        chosen = np.minimum(chosen, len(corners) - 1)
        return chosen, np.einsum("nk,nkc->nc", barycentric(random[:, 1:]), corners[chosen])

    chunks = parallel_map(points_from, range(0, count, POINTS_AT_A_TIME), count)
    return np.concatenate([chunk[0] for chunk in chunks]), np.concatenate([chunk[1] for chunk in chunks])


def disk(squares: np.ndarray) -> np.ndarray:
    """Points (N,2) of the unit square mapped to the disk of diameter 1; areas stay equal (Shirley & Chiu 1997)."""
    x, y = (2.0 * squares - 1.0).T
    x_is_larger = np.abs(x) > np.abs(y)
    radius = np.where(x_is_larger, x, y)
    minor = np.where(x_is_larger, y, x)
    angle = (np.pi / 4.0) * np.divide(minor, radius, out=np.zeros_like(radius), where=radius != 0.0)
    angle = np.where(x_is_larger, angle, np.pi / 2.0 - angle)
    return 0.5 * radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])


def lattice(count: int, shift: np.ndarray) -> np.ndarray:
    """(count,2) in [0,1): a rank-1 lattice, shifted by `shift` (2,) in [0,1) (Cranley & Patterson 1976).

    Its points are more even than the first `count` points of an infinite sequence.
    """
    row = draw(Dimension.VIRTUAL_LIGHT_ROW, virtual_light=np.arange(count))[:, 0]
    return np.modf(np.column_stack([(np.arange(count) + 0.5) / count, row]) + shift)[0]


def sphere(squares: np.ndarray) -> np.ndarray:
    """Directions (N,3) for points (N,2) of the unit square, by the equal-area cylindrical projection."""
    height, angle = 1.0 - 2.0 * squares[:, 0], 2.0 * np.pi * squares[:, 1]
    radius = np.sqrt(1.0 - height * height)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), height])
