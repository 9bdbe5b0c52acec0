# SPDX-License-Identifier: GPL-3.0-or-later
"""A bilateral blur of the ambient occlusion, along rows, then along columns.

The weight of a neighbour is the similarity of its surface. Beck-Norén & Valter 2013, section 3.3, blur their result at
half resolution too.
"""

from functools import cached_property

import moderngl

from ....resources import NORMAL, POSITION
from ....resources.world import AMBIENT_OCCLUSION, HALF_BLURRED_OCCLUSION, RAW_OCCLUSION
from ...drawing import draw_pixels
from ...frame import Frame, Pass, outputs
from ...gl.shader_compiler import bind


class BlurOcclusion(Pass):
    """The smoothed occlusion at half resolution."""

    inputs = POSITION, NORMAL, RAW_OCCLUSION
    outputs = outputs(HALF_BLURRED_OCCLUSION, AMBIENT_OCCLUSION)

    @cached_property
    def pixels(self) -> moderngl.VertexArray:
        return self.full_screen_program()

    def needed(self, frame: Frame) -> bool:
        return not frame.is_neutral(RAW_OCCLUSION)

    def execute(self, frame: Frame) -> None:
        frame.device.overwrite()
        for source, target, along in (
            (RAW_OCCLUSION, HALF_BLURRED_OCCLUSION, (1, 0)),
            (HALF_BLURRED_OCCLUSION, AMBIENT_OCCLUSION, (0, 1)),
        ):
            bind(
                self.pixels.program,
                position=frame[POSITION],
                normal=frame[NORMAL],
                occlusion=frame[source],
                along=along,
            )
            draw_pixels(frame, frame.framebuffer(target), self.pixels)
