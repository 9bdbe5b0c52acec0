# SPDX-License-Identifier: GPL-3.0-or-later
"""Faint lights as SelectFaintLights leaves them, and which of them a sample draws."""

import numpy as np

#: A light that is faint in a tile: its predicted visibility, how often it is drawn, and when.
FAINT_LIGHT = np.dtype([("tile", "i8"), ("light", "i8"), ("visibility", "f4"), ("probability", "f4"), ("phase", "f4")])


def drawn_pairs(pairs: np.ndarray, tiles: np.ndarray, columns: int, rows: int, sample: int) -> np.ndarray:
    """Rows of TILE for the pairs that a sample draws in these tiles. Sample indices count those that a pair had.

    The first sample draws all.
    """
    taking_part = np.full(columns * rows, -1)
    taking_part[tiles["tile"].astype(np.int64) @ (1, columns)] = np.arange(len(tiles))
    pairs = pairs[taking_part[pairs["tile"]] >= 0]
    found = tiles[taking_part[pairs["tile"]]]
    probability = pairs["probability"] if sample > 0 else np.ones(len(pairs), np.float32)
    turn = found["sample_index"] * probability + pairs["phase"]
    found["sample_index"], found["ray_probability"] = np.floor(turn), probability
    found["light"], found["visibility"] = pairs["light"], pairs["visibility"]
    return found[np.floor(turn + probability) > found["sample_index"]]
