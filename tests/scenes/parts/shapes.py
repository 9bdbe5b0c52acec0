# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces of quads with texture coordinates in metres: boxes, lathed profiles, swept rings, grids."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Shape:
    """A surface of quads: positions (V,3) m, quads (F,4), uvs (F,4,2) m along the surface."""

    positions: np.ndarray
    quads: np.ndarray
    uvs: np.ndarray

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0, angle: float = 0.0) -> "Shape":
        """The shape rotated about the z axis by `angle` radians, then moved."""
        cosine, sine = np.cos(angle), np.sin(angle)
        rotation = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
        return Shape(self.positions @ rotation.T + (x, y, z), self.quads, self.uvs)

    def transformed(self, matrix: Sequence[Sequence[float]]) -> "Shape":
        """The shape transformed by an affine matrix (4,4), its texture coordinates kept."""
        affine = np.array(matrix)
        return Shape(self.positions @ affine[:3, :3].T + affine[:3, 3], self.quads, self.uvs)


def join(shapes: Sequence[Shape]) -> Shape:
    """One shape of several."""
    offsets = np.cumsum([0] + [len(shape.positions) for shape in shapes])
    return Shape(
        np.concatenate([shape.positions for shape in shapes]),
        np.concatenate([shape.quads + offset for shape, offset in zip(shapes, offsets[:-1], strict=True)]),
        np.concatenate([shape.uvs for shape in shapes]),
    )


def grid(positions: np.ndarray, uvs: np.ndarray) -> Shape:
    """The surface through a grid of points (R,C,3) with uvs (R,C,2)."""
    rows, columns = positions.shape[:2]
    index = np.arange(rows * columns).reshape(rows, columns)
    quads = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], axis=-1).reshape(-1, 4)
    return Shape(positions.reshape(-1, 3), quads, uvs.reshape(-1, 2)[quads])


def box(low: Sequence[float], high: Sequence[float]) -> Shape:
    """A box between two corners. The uvs of a side are its own two coordinates."""
    is_high = np.array([[(i >> axis) & 1 for axis in range(3)] for i in range(8)])
    positions = np.where(is_high == 1, high, low).astype(float)
    quads = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
    axes = np.array([(0, 1), (0, 1), (0, 2), (0, 2), (1, 2), (1, 2)])
    uvs = np.take_along_axis(positions[quads], axes[:, None, :].repeat(4, axis=1), axis=2)
    return Shape(positions, quads, uvs)


def lathe(profile: np.ndarray, segments: int, lobes: int = 0, depth: np.ndarray | float = 0.0) -> Shape:
    """A profile (N,2) of radius and height, bottom first, rotated about the z axis.

    `lobes` waves around the axis reduce the radius by up to `depth` (N,) metres: flutes and leaves.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, segments + 1)
    carved = np.broadcast_to(np.asarray(depth), len(profile))[:, None] * np.abs(np.sin(0.5 * lobes * angles))
    radius = profile[:, :1] - carved
    circles = np.stack([radius * np.cos(angles), radius * np.sin(angles)], axis=-1)
    height = np.broadcast_to(profile[:, 1, None, None], (*radius.shape, 1))
    around = angles * profile[:, 0].max()
    along = path_length(profile)
    uvs = np.stack(np.broadcast_arrays(around[None, :], along[:, None]), axis=-1)
    surface = grid(np.concatenate([circles, height], axis=-1), uvs)
    return Shape(surface.positions, close_grid(surface.quads, len(profile), segments + 1), surface.uvs)


def close_grid(quads: np.ndarray, rows: int, columns: int) -> np.ndarray:
    """Quads of a grid whose last column of points is replaced by its first."""
    index = np.arange(rows * columns).reshape(rows, columns)
    index[:, -1] = index[:, 0]
    return index.reshape(-1)[quads]


def ring(profile: Sequence[tuple[float, float]], half_x: float, half_y: float) -> Shape:
    """A profile of (distance outwards, height) swept around a rectangle and mitred at its corners."""
    line = np.array(profile)
    along = path_length(line)
    sides = []
    for (sx, sy), (tx, ty) in zip(CORNERS, CORNERS[1:] + CORNERS[:1], strict=True):
        ends = [
            np.stack([x * (half_x + line[:, 0]), y * (half_y + line[:, 0]), line[:, 1]], axis=-1)
            for x, y in ((sx, sy), (tx, ty))
        ]
        axis = 0 if sy == ty else 1
        uvs = np.stack([np.stack([end[:, axis], along], axis=-1) for end in ends], axis=1)
        sides.append(grid(np.stack(ends, axis=1), uvs))
    return join(sides)


def rounded_profile(profile: Sequence[tuple[float, float]], rounds: int = 3) -> np.ndarray:
    """A profile (N,2) with its corners cut several times, except the ends: a quadratic B-spline."""
    points = np.array(profile, float)
    for _ in range(rounds):
        cut = np.stack([0.75 * points[:-1] + 0.25 * points[1:], 0.25 * points[:-1] + 0.75 * points[1:]], axis=1)
        points = np.concatenate([points[:1], cut.reshape(-1, 2), points[-1:]])
    return points


def path_length(points: np.ndarray) -> np.ndarray:
    """(N,): the length of the path through points (N,D) up to each of them."""
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(lengths)])


CORNERS = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
