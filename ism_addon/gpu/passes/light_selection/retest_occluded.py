# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights that all rays found occluded are tested again, now and then.

Each sample tests a few pairs of a tile and a light. The probability follows the light's bound, so many negligible
lights cost no more than one. PredictVisibility and TraceShadows draw a light from the sample on in which it is found.
"""

from functools import cached_property

import moderngl
import numpy as np

from ....resources import (
    LIGHT_BUFFER,
    LIGHT_INFLUENCE,
    PROBE_SPACING,
    REDISCOVERED,
    RETEST_CANDIDATES,
    RETESTS,
    TILE_VISIBILITY,
    TLAS,
)
from ....sampling.dimensions import PIXEL_INCREMENTS, Dimension, fixed_point, sequence
from ....scene import Change
from ...culling.light_influence import visibilities
from ...drawing import draw_tiles
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.shader_compiler import bind
from ...gl.shader_records import CASTER, LIGHT, MEMBERSHIP
from ...surface_inputs import SURFACE, surface_samplers
from ...tiles import PROBES_PER_TILE_SIDE, TILE

#: Probability of a retest, in a sample and a tile, of a light that could be all the light there is.
RETEST_PROBABILITY = 0.25


class RetestOccluded(Pass):
    """Where lights arrive that had seemed occluded."""

    inputs = *SURFACE, LIGHT_BUFFER, TLAS, LIGHT_INFLUENCE, Change.LIGHTS, Change.SAMPLE
    feedback = (TILE_VISIBILITY,)
    outputs = outputs(RETESTS, RETEST_CANDIDATES, REDISCOVERED)

    @cached_property
    def program(self) -> moderngl.Program:
        return self.tile_program(LIGHT, CASTER, MEMBERSHIP, probe_spacing=PROBE_SPACING)

    def needed(self, frame: Frame) -> bool:
        return frame.casts_shadows and frame.sample > 0

    def execute(self, frame: Frame) -> None:
        target, doubling = frame.framebuffer(RETESTS), Schedule.DOUBLING.is_due
        if frame.sample == 1:
            frame[REDISCOVERED] = {}
        if doubling(frame.sample) or doubling(frame.sample - 1):  # CullLights comes before, PredictVisibility after
            frame[RETEST_CANDIDATES] = self.candidates(frame)
        if doubling(frame.sample):
            frame[REDISCOVERED] = self.rediscovered(frame)
        if doubling(frame.sample) or frame.sample == 1:
            target.clear()
        tiles = self.pairs_to_retest(frame)
        frame.counts["retests"] += len(tiles) * PROBES_PER_TILE_SIDE**2
        self.device.gl.enable_only(moderngl.BLEND)
        self.device.gl.blend_func = moderngl.ONE, moderngl.ONE
        bind(
            self.program,
            **surface_samplers(frame),
            lights=frame[LIGHT_BUFFER],
            pixel_offset=(frame.sample % PROBE_SPACING, frame.sample // PROBE_SPACING % PROBE_SPACING),
            pixel_steps=fixed_point(PIXEL_INCREMENTS),
            light_uv=fixed_point(sequence(Dimension.RETEST_POINT, frame.sample, 1)[0]),
            **frame[TLAS],
        )
        draw_tiles(frame, target, self.program, tiles, side=PROBES_PER_TILE_SIDE)

    @staticmethod
    def candidates(frame: Frame) -> tuple[np.ndarray, np.ndarray]:
        """Lights (N,) believed occluded, and cumulative probabilities (N rows columns,) of their tiles."""
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
        """Rows of TILE: each pair of a light and a tile by its probability (systematic sampling)."""
        lights, sums = frame[RETEST_CANDIDATES]
        if not len(lights):
            return np.zeros(0, TILE)
        turn = sequence(Dimension.RETEST_TURN, frame.sample, 1)[0, 0]
        picks = np.searchsorted(sums, np.arange(turn, sums[-1]), side="right")
        light, row, column = np.unravel_index(picks, (len(lights), *frame.tiles[::-1]))
        tiles = np.zeros(len(picks), TILE)
        tiles["tile"] = np.stack([column, row], 1)
        tiles["light"] = lights[light]
        return tiles

    def rediscovered(self, frame: Frame) -> dict[int, np.ndarray]:
        """Of each light that was found since the last doubling, in which tiles: (rows,columns) bool."""
        self.device.wait()
        indices, squares, count, _ = np.moveaxis(frame.read(RETESTS).astype(np.float64), -1, 0)
        alone = (count > 0.0) & (indices * indices == squares * count)  # of two lights at one pixel, none can be told
        found: dict[int, np.ndarray] = {}
        row, column = np.nonzero(alone)
        for light in np.unique(indices[alone] / count[alone]).astype(int) - 1:
            here = indices[alone] == count[alone] * (light + 1)
            found[int(light)] = np.zeros(frame.tiles[::-1], bool)
            found[int(light)][row[here] // PROBES_PER_TILE_SIDE, column[here] // PROBES_PER_TILE_SIDE] = True
        return found
