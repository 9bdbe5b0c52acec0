# SPDX-License-Identifier: GPL-3.0-or-later
"""Emission that the camera sees at the samples' positions: of surfaces, and of lights before them."""

from ....resources import DEPTH, PRIMITIVE, SAMPLE_EMISSION, TILES
from ....scene import Change
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl.shader_compiler import bind
from .seen_emission import EMISSION, emission_constants, emission_parts, emission_uniforms


class ShadeEmission(Pass):
    """Radiance of the surface and of the lights before it, W/(sr m²)."""

    inputs = (*EMISSION, TILES, PRIMITIVE, DEPTH, Change.VIEW)
    outputs = outputs(SAMPLE_EMISSION)

    def execute(self, frame: Frame) -> None:
        self.device.overwrite()
        program = self.tile_program(*emission_parts(frame), **emission_constants(frame))
        bind(program, normal=frame[PRIMITIVE], depth=frame[DEPTH], **emission_uniforms(frame))
        draw_tiles(frame, frame.framebuffer(SAMPLE_EMISSION), program)
