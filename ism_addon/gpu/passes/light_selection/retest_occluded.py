# SPDX-License-Identifier: GPL-3.0-or-later
"""Retests pairs of a tile and a light for which all rays so far were occluded.

Each sample tests a few pairs. The probability of a pair is proportional to the light's bound, so many negligible lights
cost no more than one. From the next doubling on, PredictVisibility and TraceShadows draw the lights that were visible.
"""

import math
from dataclasses import dataclass

import moderngl
import numpy as np

from ....resources import (
    LIGHT_BUFFERS,
    LIGHT_INFLUENCE,
    PROBE_SPACING,
    REDISCOVERED,
    RETEST_CANDIDATES,
    RETESTS,
    TILE_VISIBILITY,
    TLAS,
)
from ....sampling.dimensions import Dimension, draw, fixed_increments
from ....scene import Change
from ...culling.light_influence import visibilities
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.render_targets import pixels
from ...surface_inputs import SURFACE
from ...tiles import PROBES_PER_TILE_SIDE, TILE
from .probe_rays import ProbeGrid, light_blocks, trace_blocks

#: Probability that a sample retests a light in a tile, if the light's bound equals the tile's irradiance. See `dev.py
#: bench constants` in docs/benchmarks.md.
RETEST_PROBABILITY = 0.25


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


class RetestOccluded(Pass):
    """Where lights are visible that had been believed occluded."""

    inputs = *SURFACE, LIGHT_BUFFERS, TLAS, LIGHT_INFLUENCE, Change.LIGHTS, Change.SAMPLE
    feedback = (TILE_VISIBILITY,)
    outputs = outputs(RETESTS, RETEST_CANDIDATES, REDISCOVERED)

    def needed(self, frame: Frame) -> bool:
        return frame.casts_shadows and frame.sample > 0

    def execute(self, frame: Frame) -> None:
        doubling = Schedule.DOUBLING.is_due
        if frame.sample == 1:
            frame[REDISCOVERED] = {}
        if doubling(frame.sample) or doubling(frame.sample - 1):  # CullLights comes before, PredictVisibility after
            frame[RETEST_CANDIDATES] = self.candidates(frame)
        if doubling(frame.sample):
            frame[REDISCOVERED] = self.rediscovered(frame)
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
    def candidates(frame: Frame) -> tuple[np.ndarray, np.ndarray]:
        """Lights (N,) assumed occluded, and cumulative probabilities (N rows columns,) of their tiles."""
        coarse = visibilities(frame[LIGHT_INFLUENCE], frame[REDISCOVERED])
        probabilities = {}
        for light, influence in frame[LIGHT_INFLUENCE].items():
            if frame.scene.lights.casts_shadow[light]:
                untraced = influence.is_faint | (light not in frame[TILE_VISIBILITY])
                occluded = influence.contributes & (coarse[light] == 0.0) & untraced
                probabilities[light] = RETEST_PROBABILITY * influence.relative_bound * occluded
        return np.array(list(probabilities), int), np.cumsum(list(probabilities.values()), dtype=np.float64)

    @staticmethod
    def pairs_to_retest(frame: Frame) -> np.ndarray:
        """Rows of TILE: pairs of a light and a tile, drawn by their probabilities (systematic sampling)."""
        lights, sums = frame[RETEST_CANDIDATES]
        if not len(lights):
            return np.zeros(0, TILE)
        start = float(draw(Dimension.RETEST, sample=frame.sample)[0])
        picks = np.searchsorted(sums, np.arange(start, sums[-1]), side="right")
        light, row, column = np.unravel_index(picks, (len(lights), *frame.tiles[::-1]))
        tiles = np.zeros(len(picks), TILE)
        tiles["tile"] = np.stack([column, row], 1)
        tiles["light"] = lights[light]
        return tiles

    def rediscovered(self, frame: Frame) -> dict[int, np.ndarray]:
        """By light, the tiles (rows,columns) bool where any retest since the last doubling was unoccluded."""
        self.device.wait()
        visible: dict[int, np.ndarray] = {}
        for retest in frame[RETESTS]:
            pairs = retest.tiles[retest.any_visible()]
            for light in np.unique(pairs["light"]).astype(int):
                column, row = pairs["tile"][pairs["light"] == light].astype(int).T
                visible.setdefault(int(light), np.zeros(frame.tiles[::-1], bool))[row, column] = True
        return visible


def columns_of(tiles: np.ndarray) -> int:
    """Number of columns in which the blocks of these tiles are laid out, as a square."""
    return math.isqrt(len(tiles) - 1) + 1
