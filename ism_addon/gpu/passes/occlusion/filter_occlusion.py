# SPDX-License-Identifier: GPL-3.0-or-later
"""Ambient occlusion by the rays of neighbouring pixels on the same surface, and by each pixel's own ray.

The former predicts the picture, and the difference of the latter corrects it, as shadow rays do.
"""

from ....resources import NORMAL, POSITION, TERMINATOR_OFFSET, TILES
from ....resources.world import FILTERED_ONCE, OCCLUSION_DISTANCE, TRACED_OCCLUSION
from ....scene import Change
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl.shader_compiler import bind
from ...occlusion import radius_uniforms, traces_occlusion

#: Of the filter. Each has twice the spacing of the one before.
LEVELS = 3


class FilterOcclusion(Pass):
    """The visible fraction of each pixel's cone, filtered and by its own ray."""

    inputs = (
        *(TILES, POSITION, NORMAL, TERMINATOR_OFFSET, OCCLUSION_DISTANCE, Change.VIEW),
        *("ssao.radius", "ssao.radius_pixels", "ssao.unit", "ssao.attenuation"),
    )
    outputs = outputs(FILTERED_ONCE, TRACED_OCCLUSION)

    def needed(self, frame: Frame) -> bool:
        return traces_occlusion(frame)

    def execute(self, frame: Frame) -> None:
        self.device.overwrite()
        targets = TRACED_OCCLUSION, FILTERED_ONCE
        for level in range(LEVELS):
            program = self.tile_program(first_level=int(level == 0))
            source = OCCLUSION_DISTANCE if level == 0 else targets[(level + 1) % 2]
            bind(
                program,
                position=frame[POSITION],
                normal=frame[NORMAL],
                base_color=frame[TERMINATOR_OFFSET],
                distances=frame[source],
                spacing=1 << level,
                **radius_uniforms(frame),
                **({"attenuation": frame.settings.ssao.attenuation} if level == 0 else {}),
            )
            draw_tiles(frame, frame.framebuffer(targets[level % 2]), program)
