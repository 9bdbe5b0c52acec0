# SPDX-License-Identifier: GPL-3.0-or-later
"""The radiance of a pixel towards the camera, in linear light.

It is the radiance by the lights, plus the base color times the world's radiance times ambient visibility. In the
background it is the world's. Emissive surfaces and lights that the camera sees add theirs. Occlusion is upsampled to
full resolution from the half-resolution pixels that show the same surface.
"""

from typing import Any

import numpy as np

from ....resources import (
    AMBIENT_OCCLUSION,
    BASE_COLOR,
    DEPTH,
    DIRECT_PREDICTION,
    DIRECT_RESIDUAL,
    LIGHT_BUFFERS,
    MATERIAL_BUFFERS,
    MESH_BUFFERS,
    NORMAL,
    POSITION,
    PRIMITIVE,
    SAMPLE_COLOR,
    SAMPLE_HEADROOM,
    SAMPLE_RESIDUAL,
    SEEN_LIGHTS,
    TILES,
)
from ....scene import Change
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl.shader_compiler import bind
from ...gl.shader_records import LIGHT_RECORDS, MATERIAL
from ...lights import mixed_variant
from ...lights.world import has_world


class Shade(Pass):
    """The image of one sample, alpha premultiplied; its residual and its headroom."""

    inputs = (
        *(TILES, POSITION, NORMAL, DEPTH, BASE_COLOR, DIRECT_PREDICTION, DIRECT_RESIDUAL, AMBIENT_OCCLUSION),
        *(SEEN_LIGHTS, LIGHT_BUFFERS, PRIMITIVE, MATERIAL_BUFFERS, MESH_BUFFERS, Change.WORLD, Change.VIEW),
    )
    outputs = outputs(SAMPLE_COLOR, SAMPLE_RESIDUAL, SAMPLE_HEADROOM)

    def execute(self, frame: Frame) -> None:
        self.device.overwrite()
        seen, occluded = frame.get(SEEN_LIGHTS), int(not frame.is_neutral(AMBIENT_OCCLUSION))
        emissive = frame[MATERIAL_BUFFERS].emissive
        records = *(LIGHT_RECORDS if seen is not None else ()), *((MATERIAL,) if emissive else ())
        visible = np.flatnonzero(frame.scene.lights.visible_camera).tolist()
        seen_variant: dict[str, Any] = mixed_variant(frame.scene.lights, visible) if seen is not None else {}
        program = self.tile_program(
            *records,
            occluded=occluded,
            seen_lights=int(seen is not None),
            emissive=int(emissive),
            **seen_variant,
        )
        if emissive:
            materials, corners = frame[MATERIAL_BUFFERS].table, frame[MESH_BUFFERS].samplers["corners"]
            bind(program, primitive=frame[PRIMITIVE], materials=materials, corners=corners)
        if seen is not None:
            bind(program, **frame[LIGHT_BUFFERS], seen_lights=seen, seen_count=len(visible))
        bind(
            program,
            position=frame[POSITION],
            normal=frame[NORMAL],
            depth=frame[DEPTH],
            base_color=frame[BASE_COLOR],
            direct_prediction=frame[DIRECT_PREDICTION],
            direct_residual=frame[DIRECT_RESIDUAL],
            ambient_occlusion=frame[AMBIENT_OCCLUSION],
            world=tuple(frame.scene.world.radiance),
            ambient=tuple(frame.scene.world.radiance * (not has_world(frame.scene.lights))),
            background=0.0 if frame.view.transparent else 1.0,
        )
        draw_tiles(frame, frame.framebuffer(SAMPLE_COLOR, SAMPLE_RESIDUAL, SAMPLE_HEADROOM), program)
