# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth the ambient occlusion's noise, along surfaces only.

A bilateral filter in two steps, across and up: a neighbour counts as far as it lies in the pixel's plane and faces
the same way (Beck-Norén & Valter 2013, section 3.3, blur their half-resolution result likewise).
"""

from functools import cached_property

import moderngl

from ...frame import Frame, Pass
from ...gl.render_targets import Target
from ...gl.shader_compiler import bind


class BlurOcclusion(Pass):
    """The smoothed occlusion at half resolution."""

    reads = ("position", "normal", "depth", "occlusion")
    writes = {
        "occlusion_across": Target(1, "f2", neutral=(1.0,), divisor=2),
        "smooth_occlusion": Target(1, "f2", neutral=(1.0,), divisor=2),
    }

    @cached_property
    def pixels(self) -> moderngl.VertexArray:
        return self.full_screen_program()

    def needed(self, frame: Frame) -> bool:
        return frame.occludes

    def draw(self, frame: Frame) -> None:
        frame.device.gl.enable_only(moderngl.NOTHING)
        for source, into, along in (
            ("occlusion", "occlusion_across", (1, 0)),
            ("occlusion_across", "smooth_occlusion", (0, 1)),
        ):
            bind(
                self.pixels.program,
                position=frame.targets["position"],
                normals=frame.targets["normal"],
                depth=frame.targets["depth"],
                occlusion=frame.targets[source],
                along=along,
            )
            self.draw_pixels(frame, frame.targets.into(into), self.pixels)
