# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles of the picture: how those that take part in a draw are told to the GPU, and targets of a texel a tile read."""

import numpy as np

from ..resources import PROBE_SPACING, TILE_SIZE

#: Probe rays along a side of a tile.
PROBES_PER_TILE_SIDE = TILE_SIZE // PROBE_SPACING

#: A tile that is drawn.
TILE = np.dtype(
    [
        ("tile", "f4", 2),  # column and row
        ("visibility_texel", "f4", 2),  # of its pixels' sample in the visibility buffer's grid
        ("subpixel_offset", "f4", 2),  # of that sample from the pixel's centre, px
        ("sample_index", "f4"),  # of that sample among the tile's own
        ("ray_probability", "f4"),  # with which a pass draws it; 0 if each pixel has its own
        ("light", "f4"),  # that it is drawn for
        ("visibility", "f4"),  # predicted for all of its pixels
    ]
)

#: The same for a PointBatch: vertex attributes of glsl/tiles.vert.
TILE_LAYOUT = (
    "2f 4f 1f 1f 1f 1f",
    *("in_tile", "in_visibility_texel_and_offset", "in_sample_index", "in_probability", "in_light", "in_visibility"),
)


def tiles_where(chosen: np.ndarray) -> np.ndarray:
    """Rows of TILE for those chosen of (rows,columns) bool; all but where they are is 0."""
    tiles = np.zeros(np.count_nonzero(chosen), TILE)
    tiles["tile"] = np.argwhere(chosen)[:, ::-1]
    return tiles


def from_strips(texels: np.ndarray, tiles: tuple[int, int]) -> np.ndarray:
    """(rows,columns,N) of what a target for so many columns and rows of tiles holds in strips, (H,W,N)."""
    columns, rows = tiles
    return texels.reshape(-1, texels.shape[2])[: columns * rows].reshape(rows, columns, -1)
