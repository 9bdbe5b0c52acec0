# SPDX-License-Identifier: GPL-3.0-or-later
"""Retests pairs of a tile and a light for which all rays so far were occluded.

Each sample tests a few pairs. The probability of a pair is proportional to the light's bound, so many negligible lights
cost no more than one. From the next doubling on, PredictVisibility and TraceShadows draw the lights that were visible.
"""

import moderngl
import numpy as np

from ....resources import (
    HIDDEN_LIGHTS,
    LIGHT_BUFFERS,
    LIGHT_INFLUENCE,
    POINT_GRAPHS,
    PROBE_SPACING,
    REDISCOVERED,
    RETEST_CANDIDATES,
    RETESTS,
    TILE_VISIBILITY,
    TLAS,
)
from ....sampling.dimensions import Dimension, draw, fixed_increments
from ....scene import Change
from ...culling.hidden_lights import COARSE_SIDE, coarse_tiles_of
from ...culling.light_influence import visibilities
from ...frame import Frame, Pass, Schedule, outputs
from ...surface_inputs import SURFACE
from ...tiles import PROBES_PER_TILE_SIDE, TILE
from .probe_rays import ProbeGrid, light_blocks, trace_blocks
from .retests import Candidates, Retest, columns_of

#: Probability that a sample retests a light in a tile, if the light's bound equals the tile's irradiance. See `dev.py
#: bench constants` in docs/benchmarks.md.
RETEST_PROBABILITY = 0.25


class RetestOccluded(Pass):
    """Where lights are visible that had been believed occluded."""

    inputs = (
        *(*SURFACE, LIGHT_BUFFERS, TLAS, POINT_GRAPHS, LIGHT_INFLUENCE, HIDDEN_LIGHTS, REDISCOVERED),
        *(Change.LIGHTS, Change.SAMPLE),
    )
    feedback = (TILE_VISIBILITY,)
    outputs = outputs(RETESTS, RETEST_CANDIDATES)

    def needed(self, frame: Frame) -> bool:
        return frame.casts_shadows and frame.sample > 0

    def execute(self, frame: Frame) -> None:
        doubling = Schedule.DOUBLING.is_due
        if doubling(frame.sample) or doubling(frame.sample - 1):  # CullLights comes before, PredictVisibility after
            frame[RETEST_CANDIDATES] = self.candidates(frame)
        tiles = self.pairs_to_retest(frame)
        frame.counts["retests"] += len(tiles) * PROBES_PER_TILE_SIDE**2
        earlier = () if doubling(frame.sample) or frame.sample == 1 else frame[RETESTS]
        frame[RETESTS] = (*earlier, Retest(tiles, self.trace(frame, tiles))) if len(tiles) else earlier

    @staticmethod
    def trace(frame: Frame, tiles: np.ndarray) -> moderngl.Texture:
        """Trace a PROBE texture with a block for each row of TILE. From each texel a ray goes to the tile's light."""
        lights = tiles["light"].astype(int)
        blocks = light_blocks(lights, draw(Dimension.RETEST_POINT, sample=frame.sample, light=lights))
        blocks["first_texel"] = tiles["tile"] * PROBES_PER_TILE_SIDE
        offset = frame.sample % PROBE_SPACING, frame.sample // PROBE_SPACING % PROBE_SPACING
        light_uv_steps = fixed_increments(Dimension.RETEST_POINT, "probe")
        size = PROBES_PER_TILE_SIDE, PROBES_PER_TILE_SIDE
        return trace_blocks(frame, blocks, ProbeGrid(size, PROBE_SPACING, offset, light_uv_steps, columns_of(tiles)))

    @staticmethod
    def candidates(frame: Frame) -> Candidates:
        """The lights assumed occluded."""
        coarse = visibilities(frame[LIGHT_INFLUENCE], frame[REDISCOVERED])
        hidden, relative_bounds = frame[HIDDEN_LIGHTS]
        probabilities = {}
        for light, influence in frame[LIGHT_INFLUENCE].items():
            if frame.scene.lights.casts_shadow[light]:
                untraced = influence.is_faint | (light not in frame[TILE_VISIBILITY])
                occluded = influence.contributes & (coarse[light] == 0.0) & untraced
                probabilities[light] = (RETEST_PROBABILITY * influence.relative_bound * occluded).ravel()
        in_order = np.concatenate([*probabilities.values(), RETEST_PROBABILITY * relative_bounds.ravel()])
        return Candidates(np.array(list(probabilities), int), hidden, np.cumsum(in_order, dtype=np.float64))

    @staticmethod
    def pairs_to_retest(frame: Frame) -> np.ndarray:
        """Rows of TILE: pairs of a light and a tile, drawn by their probabilities (systematic sampling)."""
        candidates, (columns, rows) = frame[RETEST_CANDIDATES], frame.tiles
        sums, tile_sums = candidates.sums, len(candidates.lights) * rows * columns
        if not len(sums):
            return np.zeros(0, TILE)
        points = np.arange(float(draw(Dimension.RETEST, sample=frame.sample)[0]), sums[-1])
        picks = np.searchsorted(sums, points, side="right")
        in_tiles = picks < tile_sums
        light, row, column = np.unravel_index(picks[in_tiles], (len(candidates.lights), rows, columns))
        coarse_columns, coarse_rows = coarse_tiles_of(frame.tiles)
        of_coarse = picks[~in_tiles]
        hidden, coarse_row, coarse_column = np.unravel_index(
            of_coarse - tile_sums, (len(candidates.hidden), coarse_rows, coarse_columns)
        )
        # Which tile of the coarse tile: by the position of the point between two sums.
        start = np.where(of_coarse > 0, sums[of_coarse - 1], 0.0)
        part = (points[~in_tiles] - start) / np.maximum(sums[of_coarse] - start, 1e-30)
        in_row, in_column = np.divmod(np.minimum(part * COARSE_SIDE**2, COARSE_SIDE**2 - 1).astype(int), COARSE_SIDE)
        tiles = np.zeros(len(picks), TILE)
        tiles["tile"][:, 0] = np.concatenate([column, np.minimum(COARSE_SIDE * coarse_column + in_column, columns - 1)])
        tiles["tile"][:, 1] = np.concatenate([row, np.minimum(COARSE_SIDE * coarse_row + in_row, rows - 1)])
        tiles["light"] = np.concatenate([candidates.lights[light], candidates.hidden[hidden]])
        return tiles
