# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights that are a small part of a tile's light: in which tiles, and how often they are drawn there.

They have no prediction of their own, however many they are: CullLights estimates one visibility for all pixels of a
tile. The fainter a light is, the lower is its probability in a sample, and the higher its weight.
"""

from collections.abc import Mapping

import numpy as np

from ....sampling.dimensions import LIGHT_INCREMENTS, TURN_INCREMENTS, members
from ...culling.light_influence import LightInfluence, visibilities

#: The least probability that a faint light is drawn in a tile.
MIN_LIGHT_PROBABILITY = 0.25

#: A light that is faint in a tile: its predicted visibility, how often it is drawn, and when.
FAINT_LIGHT = np.dtype([("tile", "i8"), ("light", "i8"), ("visibility", "f4"), ("probability", "f4"), ("phase", "f4")])


def faint_light_pairs(influences: Mapping[int, LightInfluence], rediscovered: Mapping[int, np.ndarray]) -> np.ndarray:
    """Rows of FAINT_LIGHT for all tiles and the lights that are faint there; `rediscovered` as in resources.py."""
    found, coarse = [np.zeros(0, FAINT_LIGHT)], visibilities(influences, rediscovered)
    for light, influence in influences.items():
        visibility = (influence.is_faint * coarse[light]).ravel()
        tile = np.flatnonzero(visibility)
        pairs = np.zeros(len(tile), FAINT_LIGHT)
        pairs["tile"], pairs["light"], pairs["visibility"] = tile, light, visibility[tile]
        pairs["probability"] = np.maximum(influence.bound_over_faint.ravel()[tile], MIN_LIGHT_PROBABILITY)
        phases = members(TURN_INCREMENTS[:1], 0, visibility.size)[tile, 0] + light * LIGHT_INCREMENTS[3]
        pairs["phase"] = np.mod(phases, 1.0)
        found.append(pairs)
    return np.concatenate(found)


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
