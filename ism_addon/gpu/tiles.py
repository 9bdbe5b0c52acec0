# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles of the image: the vertices that draw them, and targets with a texel for each tile."""

import numpy as np

from ..resources import PROBE_SPACING, TILE_SIZE

#: Probe rays along each side of a tile.
PROBES_PER_TILE_SIDE = TILE_SIZE // PROBE_SPACING

#: A tile to be drawn.
TILE = np.dtype(
    [
        ("tile", "f4", 2),  # column and row
        ("visibility_texel", "f4", 2),  # in the visibility buffer's grid, from the pixel's centre
        ("subpixel_offset", "f4", 2),  # of the sample from the pixel's centre, px
        ("sample_index", "f4"),  # among the samples of this tile
        ("ray_probability", "f4"),  # with which rays are traced; 0: each pixel has a different one
        ("light", "i4"),  # index
        ("visibility", "f4"),  # predicted, of all of its pixels; below 0: each pixel has a different one
        ("tolerance", "f4"),  # change of luminance that is as visible as 1 where the picture's mean is
    ]
)

#: TILE as the vertex attributes of glsl/tiles.vert, see PointBatch.
TILE_LAYOUT = (
    "2f 4f 1f 1f 1i 1f 1f",
    *("in_tile", "in_visibility_texel_and_offset", "in_sample_index", "in_probability", "in_light", "in_visibility"),
    "in_tolerance",
)

#: What a sample costs whatever tiles take part, in draws of tiles: of one core 30 to 100, and of several as many times
#: more, as tiles are drawn by all.
TILES_PER_SAMPLE = 300.0


def relative_cost(tiles: int) -> float:
    """Time of a sample over that of drawing its tiles: near 1 in large pictures."""
    return 1.0 + TILES_PER_SAMPLE / tiles


def tiles_where(chosen: np.ndarray) -> np.ndarray:
    """Rows of TILE for those chosen of (rows,columns) bool; all fields but `tile` are 0."""
    tiles = np.zeros(np.count_nonzero(chosen), TILE)
    tiles["tile"] = np.argwhere(chosen)[:, ::-1]
    return tiles


def from_strips(texels: np.ndarray, tiles: tuple[int, int]) -> np.ndarray:
    """(rows,columns,N) from the texels (H,W,N) of a target in strips, for columns × rows tiles."""
    columns, rows = tiles
    return texels.reshape(-1, texels.shape[2])[: columns * rows].reshape(rows, columns, -1)


def repeated(values: np.ndarray, side: int, tiles: tuple[int, int]) -> np.ndarray:
    """(rows,columns): values (R,C) of squares of side×side tiles, for each of columns × rows tiles."""
    return values.repeat(side, 0).repeat(side, 1)[: tiles[1], : tiles[0]]


def neighbourhood_max(values: np.ndarray) -> np.ndarray:
    """(H,W): the maximum of each 3×3 neighbourhood."""
    rows = values.copy()
    np.maximum(rows[1:], values[:-1], out=rows[1:])
    np.maximum(rows[:-1], values[1:], out=rows[:-1])
    maxima = rows.copy()
    np.maximum(maxima[:, 1:], rows[:, :-1], out=maxima[:, 1:])
    np.maximum(maxima[:, :-1], rows[:, 1:], out=maxima[:, :-1])
    return maxima
