# SPDX-License-Identifier: GPL-3.0-or-later
"""The radiance of a pixel towards the camera, in linear light.

It is the radiance by the lights, plus the albedo times the world's radiance if that is even and no light. Ambient
occlusion darkens one or both. In the background it is the world's. Accumulate adds what surfaces and lights emit.
"""

from typing import Any

from ....choices import OccludedLight
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
from ....resources.world import (
    AMBIENT_OCCLUSION,
    BACKGROUND,
    STEADY_OCCLUSION,
    TRACED_OCCLUSION,
)
from ....scene import Change
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl.shader_compiler import bind
from ...material_inputs import MATERIAL, material_constants, material_samplers
from ...occlusion import SEPARATE_WORLD, darkens, has_ambient_light, separates_world
from ...occlusion.inputs import occlusion_constants, occlusion_target, occlusion_uniforms
from ...surface_inputs import tint_constants, tint_uniforms


class Shade(Pass):
    """The image of one sample, alpha premultiplied; its residual and its headroom."""

    inputs = (
        *(TILES, POSITION, NORMAL, *MATERIAL, DIRECT_PREDICTION, DIRECT_RESIDUAL, AMBIENT_OCCLUSION),
        *(TRACED_OCCLUSION, STEADY_OCCLUSION, *SEPARATE_WORLD, TRANSMITTED_COLOR, BACKGROUND),
        *(Change.WORLD, Change.VIEW, "ssao"),
    )
    outputs = outputs(SAMPLE_COLOR, SAMPLE_RESIDUAL, SAMPLE_HEADROOM)

    def execute(self, frame: Frame) -> None:
        self.device.overwrite()
        occlusion = occlusion_target(frame) if darkens(frame) else None
        constants: dict[str, Any] = {
            **occlusion_constants(occlusion),
            "darkens_all": int(frame.settings.ssao.light is OccludedLight.ALL),
            "separate_world": int(separates_world(frame)),
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
            **(occlusion_uniforms(frame, occlusion) if occlusion else {}),
            **({target.name: frame[target] for target in SEPARATE_WORLD} if separates_world(frame) else {}),
            background=frame[BACKGROUND],
            even_background=tuple(world.background * (world.graph[1] < 0)),
            ambient=tuple(world.radiance * has_ambient_light(frame)),
            **tint_uniforms(frame),
            film=0.0 if frame.view.transparent else 1.0,
        )
        draw_tiles(frame, frame.framebuffer(SAMPLE_COLOR, SAMPLE_RESIDUAL, SAMPLE_HEADROOM), program)
