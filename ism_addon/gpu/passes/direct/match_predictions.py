# SPDX-License-Identifier: GPL-3.0-or-later
"""Which pixel's predictions belong to a surface.

Predictions belong to the surface that was visible at a pixel when they were made. If another one is visible now, those
of a neighbour on that surface are used instead.
"""

from functools import cached_property

import moderngl

from ....resources import IRRADIANCE_CACHE, NORMAL, POSITION, PREDICTED_PIXEL, PREDICTION_SURFACE, TILES
from ....scene import Change
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl.shader_compiler import bind


class MatchPredictions(Pass):
    """The neighbour of each pixel whose predictions are those of its surface."""

    inputs = PREDICTION_SURFACE, IRRADIANCE_CACHE, POSITION, NORMAL, TILES, Change.SAMPLE
    outputs = outputs(PREDICTED_PIXEL)

    @cached_property
    def program(self) -> moderngl.Program:
        return self.tile_program()

    def needed(self, frame: Frame) -> bool:
        """Whether there are predictions. Those of the first picture are its own, so only cached irradiance needs it."""
        return frame.casts_shadows and (frame.corrects or bool(frame.get(IRRADIANCE_CACHE)))

    def execute(self, frame: Frame) -> None:
        self.device.overwrite()
        surfaces = {"position": frame[POSITION], "normal": frame[NORMAL]}
        bind(self.program, **surfaces, prediction_surface=frame[PREDICTION_SURFACE])
        draw_tiles(frame, frame.framebuffer(PREDICTED_PIXEL), self.program)
