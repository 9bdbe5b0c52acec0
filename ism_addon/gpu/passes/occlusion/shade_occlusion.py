# SPDX-License-Identifier: GPL-3.0-or-later
"""What ambient occlusion leaves of white light: a sample of the render pass AO."""

from typing import Any

from ....resources import NORMAL, POSITION, TERMINATOR_OFFSET, TILES
from ....resources.world import (
    AMBIENT_OCCLUSION,
    SAMPLE_OCCLUSION,
    SAMPLE_OCCLUSION_HEADROOM,
    SAMPLE_OCCLUSION_RESIDUAL,
    STEADY_OCCLUSION,
    TRACED_OCCLUSION,
)
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl.shader_compiler import bind
from ...occlusion.inputs import occlusion_constants, occlusion_target, occlusion_uniforms


class ShadeOcclusion(Pass):
    """A sample of the render pass AO, its residual and its headroom."""

    inputs = TILES, POSITION, NORMAL, TERMINATOR_OFFSET, AMBIENT_OCCLUSION, TRACED_OCCLUSION, STEADY_OCCLUSION, "ssao"
    outputs = outputs(SAMPLE_OCCLUSION, SAMPLE_OCCLUSION_RESIDUAL, SAMPLE_OCCLUSION_HEADROOM)

    def execute(self, frame: Frame) -> None:
        self.device.overwrite()
        target = occlusion_target(frame)
        constants: dict[str, Any] = {**occlusion_constants(target)}
        program = self.tile_program(**constants)
        bind(
            program,
            position=frame[POSITION],
            normal=frame[NORMAL],
            base_color=frame[TERMINATOR_OFFSET],
            **(occlusion_uniforms(frame, target) if target else {}),
        )
        targets = SAMPLE_OCCLUSION, SAMPLE_OCCLUSION_RESIDUAL, SAMPLE_OCCLUSION_HEADROOM
        draw_tiles(frame, frame.framebuffer(*targets), program)
