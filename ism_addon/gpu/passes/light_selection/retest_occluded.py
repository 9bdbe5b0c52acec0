# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights that all rays found occluded are tested again, now and then.

Each sample tests a few pairs of a tile and a light. The probability follows the light's bound, so many negligible
lights cost no more than one. PredictVisibility and TraceShadows draw a light from the sample on in which it is found.
"""

from functools import cached_property

import moderngl
import numpy as np

from ....sampling import PIXEL_INCREMENTS, Dimension, fixed_point, sequence
from ....scene import Change
from ...frame import PROBE_SPACING, PROBES_PER_TILE_SIDE, RENEWED, TILE, Frame, Pass
from ...gl.context import Device
from ...gl.render_targets import Target
from ...gl.shader_compiler import bind
from ...gl.shader_records import CASTER, LIGHT, MEMBERSHIP

#: The chance, in a sample, of a block to be looked at for a light that could be all the light there is.
RETEST_PROBABILITY = 0.25


class RetestOccluded(Pass):
    """Where lights were spotted that had seemed hidden."""

    reads = ("position", "normal", "placement", "rise", "lights", "casters", "reach", "scouted")
    writes = {"checked": Target(4, "f4", divisor=PROBE_SPACING)}  # see retest_occluded.frag
    makes = ("spotted",)
    depends_on = (Change.LIGHTS, Change.SAMPLE)

    def __init__(self, device: Device):
        super().__init__(device)
        #: See retest_probabilities.
        self.hidden, self.sums = np.zeros(0, int), np.zeros(0)

    @cached_property
    def pixels(self) -> moderngl.Program:
        return self.tile_program(LIGHT, CASTER, MEMBERSHIP, probe_spacing=PROBE_SPACING)

    def needed(self, frame: Frame) -> bool:
        return frame.traces and frame.sample > 0

    def draw(self, frame: Frame) -> None:
        target = frame.targets.into("checked")
        if frame.sample == 1:
            target.clear()
            frame.tables["spotted"] = {}
        elif frame.sample in RENEWED:
            frame.tables["spotted"] = self.spotted(frame)
            target.clear()
        blocks = self.chosen(frame)
        frame.counts["pixels_checked"] += len(blocks) * PROBES_PER_TILE_SIDE**2
        self.device.gl.enable_only(moderngl.BLEND)
        self.device.gl.blend_func = moderngl.ONE, moderngl.ONE
        bind(
            self.pixels,
            **frame.receivers,
            lights=frame.tables["lights"],
            offset=(frame.sample % PROBE_SPACING, frame.sample // PROBE_SPACING % PROBE_SPACING),
            pixel_steps=fixed_point(PIXEL_INCREMENTS),
            place=fixed_point(sequence(Dimension.RETEST_POINT, frame.sample, 1)[0]),
            **frame.tables["casters"],
        )
        self.draw_tiles(frame, target, self.pixels, blocks, block=PROBES_PER_TILE_SIDE)

    def chosen(self, frame: Frame) -> np.ndarray:
        """Rows of TILE: each pair of a light and a block as often as it has a chance (systematic sampling)."""
        if {frame.sample, frame.sample - 1} & RENEWED:  # CullLights comes before this and PredictVisibility after it
            casts = frame.scene.lights.casts_shadow
            self.hidden, self.sums = retest_probabilities(frame.tables["reach"], frame.tables["found"], casts)
        if not len(self.hidden):
            return np.zeros(0, TILE)
        turn = sequence(Dimension.RETEST_TURN, frame.sample, 1)[0, 0]
        picks = np.searchsorted(self.sums, np.arange(turn, self.sums[-1]), side="right")
        light, row, column = np.unravel_index(picks, (len(self.hidden), *frame.blocks[::-1]))
        blocks = np.zeros(len(picks), TILE)
        blocks["block"] = np.stack([column, row], 1)
        blocks["light"] = self.hidden[light]
        return blocks

    def spotted(self, frame: Frame) -> dict[int, np.ndarray]:
        """Of each light that was found since the last time, in which blocks (rows,columns)."""
        self.device.wait()
        numbers, squares, count, _ = np.moveaxis(frame.targets.read("checked").astype(np.float64), -1, 0)
        alone = (count > 0.0) & (numbers * numbers == squares * count)  # of two lights at one pixel, none can be told
        found: dict[int, np.ndarray] = {}
        row, column = np.nonzero(alone)
        for light in np.unique(numbers[alone] / count[alone]).astype(int) - 1:
            here = numbers[alone] == count[alone] * (light + 1)
            found[int(light)] = np.zeros(frame.blocks[::-1], bool)
            found[int(light)][row[here] // PROBES_PER_TILE_SIDE, column[here] // PROBES_PER_TILE_SIDE] = True
        return found


def retest_probabilities(reach: dict, found: dict, casts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Numbers (N,) of lights that seem to be hidden, and sums (N rows columns,) of their blocks' chances up to each."""
    chances = {
        light: RETEST_PROBABILITY * to.part * (to.worth & (to.seen == 0.0) & (to.dim | (light not in found)))
        for light, to in reach.items()
        if casts[light]
    }
    return np.array(list(chances), int), np.cumsum(list(chances.values()), dtype=np.float64)
