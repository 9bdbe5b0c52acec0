# SPDX-License-Identifier: GPL-3.0-or-later
"""Which tiles of a sample draw a light's prediction, and in which of them rays are traced to it."""

from functools import cached_property

import numpy as np

from ....resources import LIGHT_INFLUENCE, TILE_VISIBILITY, TILES
from ....sampling.dimensions import Dimension, draw
from ...frame import Frame

# How these were chosen: `dev.py bench constants`, see docs/benchmarks.md.

#: Probability that a sample tests a tile whose prediction is certain, if the light's bound there equals the picture's
#: mean. It is proportional to the bound, as errors are, up to MAX_CERTAIN_PROBABILITY.
CERTAIN_PROBABILITY = 0.03125
MAX_CERTAIN_PROBABILITY = 0.5


class TilesOfLights:
    """The tiles of one sample by light. What does not depend on the light is computed once."""

    def __init__(self, frame: Frame):
        self.frame, self.tiles = frame, frame[TILES].copy()
        self.tiles["visibility"] = -1.0
        self.index = self.tiles["tile"].astype(np.int64) @ (1, frame.tiles[0])

    @cached_property
    def turns(self) -> np.ndarray:
        """(N,): numbers in [0,1) that decide, with a light's own, in which samples a tile tests it.

        They change after each round of subpixel offsets: otherwise rays would start at the same ones only.
        """
        rounds = self.tiles["sample_index"] // len(self.frame.grid.subpixel_offsets)
        turns: np.ndarray = draw(Dimension.TEST_TURN, tile=self.index, round=rounds)[:, 0]
        return turns

    def of_light(self, light: int, exact: bool | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Rows of TILE where rays are traced to a light, and where only its prediction is drawn, unless that is 0.

        `exact`: whether its unshadowed irradiance is exact, everywhere or as (rows,columns) bool. Where it is not, only
        darkness is certain.
        """
        frame, influence = self.frame, self.frame[LIGHT_INFLUENCE][light]
        self.tiles["light"] = light
        has_shadow = casts_shadow(frame, light)
        if has_shadow and light not in frame[TILE_VISIBILITY]:
            return self.tiles[:0], self.tiles[:0]
        predicted = np.flatnonzero((influence.contributes & ~influence.is_faint).ravel()[self.index])
        index = self.index[predicted]
        if not has_shadow:
            return self.tiles[:0], self.tiles[predicted]
        any_visible, any_occluded = frame[TILE_VISIBILITY][light].reshape(-1, 2)[index].T
        if not frame.corrects:
            return self.tiles[:0], self.tiles[predicted[any_visible]]
        probability = CERTAIN_PROBABILITY * influence.bound_over_mean.ravel()[index]
        probability = np.minimum(probability, MAX_CERTAIN_PROBABILITY)
        is_exact = np.broadcast_to(exact, frame.tiles[::-1]).ravel()[index]
        uncertain = any_visible & (any_occluded | ~is_exact)
        turn = self.turns[predicted] + draw(Dimension.TEST_TURN, light=light)[0]
        turn += (self.tiles["sample_index"][predicted] + 1.0) * probability
        tested = ~uncertain & (np.mod(turn, 1.0) < probability)
        traced = self.tiles[predicted[uncertain | tested]]
        traced["ray_probability"] = np.where(uncertain, 0.0, probability)[uncertain | tested]
        return traced, self.tiles[predicted[any_visible & ~uncertain & ~tested]]


def casts_shadow(frame: Frame, light: int) -> bool:
    """Whether shadow rays are traced to a light."""
    return frame.casts_shadows and bool(frame.scene.lights.casts_shadow[light])
