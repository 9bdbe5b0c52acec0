# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights that no ray has reached yet. Of many lights most are hidden, so they are bounded for blocks of tiles only."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from .surface_bounds import SurfaceBounds

#: Tiles along each side of a block.
BLOCK_SIDE = 4


def blocks_of(tiles: tuple[int, int]) -> tuple[int, int]:
    """Columns and rows of the blocks of columns × rows tiles."""
    columns, rows = (-(-count // BLOCK_SIDE) for count in tiles)
    return columns, rows


def surfaces_of_blocks(surfaces: SurfaceBounds, tiles: tuple[int, int]) -> SurfaceBounds:
    """Bounds of the near surfaces of each block, and after them of the far ones; `surfaces` likewise, of each tile."""
    block_columns, block_rows = blocks_of(tiles)
    blocks = surfaces.select(np.zeros(0, int))
    for offset in np.ndindex(BLOCK_SIDE, BLOCK_SIDE):
        row = np.minimum(BLOCK_SIDE * np.arange(block_rows) + offset[0], tiles[1] - 1)
        column = np.minimum(BLOCK_SIDE * np.arange(block_columns) + offset[1], tiles[0] - 1)
        near = (row[:, None] * tiles[0] + column).ravel()
        others = surfaces.select(np.concatenate([near, tiles[0] * tiles[1] + near]))
        blocks = blocks.joined(others) if len(blocks.exists) else others
    return blocks


def of_tiles(values: np.ndarray, tiles: tuple[int, int]) -> np.ndarray:
    """(rows,columns): the values (R,C) of the blocks that columns × rows tiles lie in."""
    return values.repeat(BLOCK_SIDE, 0).repeat(BLOCK_SIDE, 1)[: tiles[1], : tiles[0]]


def over_blocks(function: np.ufunc, values: np.ndarray) -> np.ndarray:
    """(R,C): values (rows,columns) of tiles reduced over their blocks, by np.add or np.maximum."""
    rows, columns = (range(0, count, BLOCK_SIDE) for count in values.shape)
    reduced: np.ndarray = function.reduceat(function.reduceat(values, rows, 0), columns, 1)
    return reduced


@dataclass(frozen=True)
class HiddenLights:
    """Upper bounds of the irradiance of H lights."""

    lights: np.ndarray  # (H,) int: their indices, ascending
    bounds: np.ndarray  # (H,R,C) float32, in R × C blocks

    @classmethod
    def none(cls, tiles: tuple[int, int]) -> Self:
        """No lights, in a picture of columns × rows tiles."""
        return cls(np.zeros(0, int), np.zeros((0, *blocks_of(tiles)[::-1]), np.float32))

    def select(self, rows: np.ndarray) -> Self:
        """The lights at indices, or where a mask (H,) bool is true."""
        return type(self)(self.lights[rows], self.bounds[rows])
