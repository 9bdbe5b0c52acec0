# SPDX-License-Identifier: GPL-3.0-or-later
"""The radiance of a pixel towards the camera, in linear light.

It is the radiance by the lights, plus the base color times the world's radiance times ambient visibility. In the
background it is the world's. Accumulate adds what surfaces and lights emit. Occlusion is upsampled to full resolution
from the half-resolution pixels that show the same surface.
"""

from typing import Any

from ....resources import (
    DIRECT_PREDICTION,
    DIRECT_RESIDUAL,
    NORMAL,
    POSITION,
    SAMPLE_COLOR,
    SAMPLE_HEADROOM,
    SAMPLE_RESIDUAL,
    TILES,
    TRANSMITTED_COLOR,
)
from ....resources.world import AMBIENT_OCCLUSION, BACKGROUND
from ....scene import Change
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl.shader_compiler import bind
from ...lights.world.table import has_world
from ...material_inputs import MATERIAL, material_constants, material_samplers
from ...surface_inputs import tint_constants, tint_uniforms


class Shade(Pass):
    """The image of one sample, alpha premultiplied; its residual and its headroom."""

    inputs = (
        *(TILES, POSITION, NORMAL, *MATERIAL, DIRECT_PREDICTION, DIRECT_RESIDUAL, AMBIENT_OCCLUSION),
        *(TRANSMITTED_COLOR, BACKGROUND),
        *(Change.WORLD, Change.VIEW, "ssao"),
    )
    outputs = outputs(SAMPLE_COLOR, SAMPLE_RESIDUAL, SAMPLE_HEADROOM)

    def execute(self, frame: Frame) -> None:
        self.device.overwrite()
        constants: dict[str, Any] = {
            "occluded": int(not frame.is_neutral(AMBIENT_OCCLUSION)),
            **material_constants(frame),
            **tint_constants(frame),
        }
        program, world = self.tile_program(**constants), frame.scene.world
        bind(
            program,
            position=frame[POSITION],
            normal=frame[NORMAL],
            **material_samplers(frame),
            direct_prediction=frame[DIRECT_PREDICTION],
            direct_residual=frame[DIRECT_RESIDUAL],
            ambient_occlusion=frame[AMBIENT_OCCLUSION],
            occlusion_intensity=frame.settings.ssao.intensity,
            occlusion_power=frame.settings.ssao.power,
            background=frame[BACKGROUND],
            even_background=tuple(world.background * (world.graph[1] < 0)),
            ambient=tuple(world.radiance * (not has_world(frame.scene.lights))),
            **tint_uniforms(frame),
            film=0.0 if frame.view.transparent else 1.0,
        )
        draw_tiles(frame, frame.framebuffer(SAMPLE_COLOR, SAMPLE_RESIDUAL, SAMPLE_HEADROOM), program)
