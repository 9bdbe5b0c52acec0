# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays to lights that are believed occluded: which of them may be retested, and what their rays found."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import moderngl
import numpy as np

from ...gl.render_targets import pixels
from ...tiles import PROBES_PER_TILE_SIDE


@dataclass(frozen=True)
class Retest:
    """The retests of one sample."""

    tiles: np.ndarray  # rows of TILE: pairs of a tile and a light
    rays: moderngl.Texture  # PROBE, see RetestOccluded.trace

    def any_visible(self) -> np.ndarray:
        """(N,) bool: whether any ray of a pair was unoccluded. Valid after Device.wait."""
        side, columns = PROBES_PER_TILE_SIDE, columns_of(self.tiles)
        rows = -(-len(self.tiles) // columns)
        rays = pixels(self.rays)[: rows * side, : columns * side, 0] == 1.0
        return rays.reshape(rows, side, columns, side).any((1, 3)).ravel()[: len(self.tiles)]


@dataclass(frozen=True)
class Candidates:
    """Lights that are assumed occluded, and the probabilities of their retests."""

    lights: np.ndarray  # (N,) int: in some tiles
    hidden: np.ndarray  # (H,) int: in all tiles; these are retested somewhere in one of R × C coarse tiles
    sums: np.ndarray  # (N rows columns + H R C,): cumulative, of tiles and then of coarse tiles


def visible_tiles(retests: Iterable[Retest], tiles: tuple[int, int]) -> dict[int, np.ndarray]:
    """By light, (rows,columns) bool: of columns × rows tiles, those where any retest was unoccluded.

    Valid after Device.wait.
    """
    visible: dict[int, np.ndarray] = {}
    for retest in retests:
        pairs = retest.tiles[retest.any_visible()]
        for light in np.unique(pairs["light"]).tolist():
            column, row = pairs["tile"][pairs["light"] == light].astype(int).T
            visible.setdefault(light, np.zeros(tiles[::-1], bool))[row, column] = True
    return visible


def columns_of(tiles: np.ndarray) -> int:
    """Number of columns in which the blocks of these tiles are laid out, as a square."""
    return math.isqrt(len(tiles) - 1) + 1
