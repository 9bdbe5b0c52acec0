# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of a tile and a light that is faint there, and which of these pairs a sample draws."""

import numpy as np

#: A light that is faint in a tile: its predicted visibility, and the probability and phase with which samples draw it.
FAINT_LIGHT = np.dtype([("tile", "i8"), ("light", "i8"), ("visibility", "f4"), ("probability", "f4"), ("phase", "f4")])

#: Nodes of a light BVH that estimate a faint light's irradiance: the irradiance cache does not have it.
ESTIMATE_NODES = 4


def drawn_pairs(pairs: np.ndarray, tiles: np.ndarray, columns: int, rows: int, sample: int) -> np.ndarray:
    """Rows of TILE: the pairs that a sample draws in these tiles. The first sample draws all pairs.

    `sample_index` counts the samples that drew the pair.
    """
    row_of_tile = np.full(columns * rows, -1)
    row_of_tile[tiles["tile"].astype(np.int64) @ (1, columns)] = np.arange(len(tiles))
    pairs = pairs[row_of_tile[pairs["tile"]] >= 0]
    drawn = tiles[row_of_tile[pairs["tile"]]]
    probability = pairs["probability"] if sample > 0 else np.ones(len(pairs), np.float32)
    position = drawn["sample_index"] * probability + pairs["phase"]
    drawn["sample_index"], drawn["ray_probability"] = np.floor(position), probability
    drawn["light"], drawn["visibility"] = pairs["light"], pairs["visibility"]
    return drawn[np.floor(position + probability) > drawn["sample_index"]]
