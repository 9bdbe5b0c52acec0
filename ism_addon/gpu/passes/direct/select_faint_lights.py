# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights that contribute a small fraction of a tile's light.

The coarse visibility of CullLights is the prediction for all pixels of the tile. The fainter a light is, the lower is
the probability that a sample draws it, and the higher its weight.
"""

from collections.abc import Mapping

import numpy as np

from ....resources import FAINT_LIGHTS, LIGHT_INFLUENCE, REDISCOVERED
from ....sampling.dimensions import Dimension, draw
from ...culling.light_influence import LightInfluence, visibilities
from ...frame import Frame, Pass, Schedule, outputs
from .faint_lights import FAINT_LIGHT

#: Minimum probability that a sample draws a faint light in a tile. See `dev.py bench constants` in docs/benchmarks.md.
MIN_LIGHT_PROBABILITY = 0.25


class SelectFaintLights(Pass):
    """Pairs of a tile and a light that is faint there."""

    schedule = Schedule.DOUBLING
    inputs = LIGHT_INFLUENCE, REDISCOVERED
    outputs = outputs(FAINT_LIGHTS)

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0

    def execute(self, frame: Frame) -> None:
        frame[FAINT_LIGHTS] = faint_light_pairs(frame[LIGHT_INFLUENCE], frame.get(REDISCOVERED) or {})


def faint_light_pairs(influences: Mapping[int, LightInfluence], rediscovered: Mapping[int, np.ndarray]) -> np.ndarray:
    """Rows of FAINT_LIGHT for all tiles and the lights that are faint there; `rediscovered` as in resources."""
    tables, coarse_visibility = [np.zeros(0, FAINT_LIGHT)], visibilities(influences, rediscovered)
    for light, influence in influences.items():
        visibility = (influence.is_faint * coarse_visibility[light]).ravel()
        tile = np.flatnonzero(visibility)
        pairs = np.zeros(len(tile), FAINT_LIGHT)
        pairs["tile"], pairs["light"], pairs["visibility"] = tile, light, visibility[tile]
        pairs["probability"] = np.maximum(influence.bound_over_faint.ravel()[tile], MIN_LIGHT_PROBABILITY)
        pairs["phase"] = draw(Dimension.LIGHT_CHOICE, light=light, tile=tile)[:, 0]
        tables.append(pairs)
    return np.concatenate(tables)
