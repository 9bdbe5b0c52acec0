# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights that no ray has reached yet. Of many lights most are hidden, so they are bounded in coarse tiles only."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from .surface_bounds import SurfaceBounds

#: Tiles along each side of a coarse tile.
COARSE_SIDE = 4


def coarse_tiles_of(tiles: tuple[int, int]) -> tuple[int, int]:
    """Columns and rows of the coarse tiles of columns × rows tiles."""
    columns, rows = (-(-count // COARSE_SIDE) for count in tiles)
    return columns, rows


def surfaces_of_coarse_tiles(surfaces: SurfaceBounds, tiles: tuple[int, int]) -> SurfaceBounds:
    """Bounds of near surfaces of each coarse tile, and after them of far ones; `surfaces` likewise, of each tile."""
    coarse_columns, coarse_rows = coarse_tiles_of(tiles)
    coarse = surfaces.select(np.zeros(0, int))
    for offset in np.ndindex(COARSE_SIDE, COARSE_SIDE):
        row = np.minimum(COARSE_SIDE * np.arange(coarse_rows) + offset[0], tiles[1] - 1)
        column = np.minimum(COARSE_SIDE * np.arange(coarse_columns) + offset[1], tiles[0] - 1)
        near = (row[:, None] * tiles[0] + column).ravel()
        others = surfaces.select(np.concatenate([near, tiles[0] * tiles[1] + near]))
        coarse = coarse.joined(others) if len(coarse.exists) else others
    return coarse


def over_coarse_tiles(function: np.ufunc, values: np.ndarray) -> np.ndarray:
    """(R,C): values (rows,columns) of tiles reduced over their coarse tiles, by np.add or np.maximum."""
    rows, columns = (range(0, count, COARSE_SIDE) for count in values.shape)
    reduced: np.ndarray = function.reduceat(function.reduceat(values, rows, 0), columns, 1)
    return reduced


@dataclass(frozen=True)
class HiddenLights:
    """Upper bounds of the irradiance of H lights."""

    lights: np.ndarray  # (H,) int: their indices, ascending
    bounds: np.ndarray  # (H,R,C) float32, in R × C coarse tiles

    @classmethod
    def none(cls, tiles: tuple[int, int]) -> Self:
        """No lights, in a picture of columns × rows tiles."""
        return cls(np.zeros(0, int), np.zeros((0, *coarse_tiles_of(tiles)[::-1]), np.float32))

    def select(self, rows: np.ndarray) -> Self:
        """The lights at indices, or where a mask (H,) bool is true."""
        return type(self)(self.lights[rows], self.bounds[rows])
