# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarse visibility of each light: one shadow ray from every fourth pixel, where CullLights asks for it."""

from typing import Any

import moderngl

from ....resources import LIGHT_BUFFER, LIGHT_INFLUENCE, PROBE, PROBE_SPACING, PROBES, TLAS
from ....sampling.dimensions import PIXEL_INCREMENTS, fixed_point, rd_sequence
from ....scene import Change
from ...drawing import draw_tiles
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.render_targets import create, size_of
from ...gl.shader_compiler import bind
from ...lights import shader_variant
from ...surface_inputs import SURFACE, surface_samplers
from ...tiles import PROBES_PER_TILE_SIDE, tiles_where
from ..direct.ray_correction import RECORDS


class ProbeVisibility(Pass):
    """For each light that casts shadows and may be visible, whether a ray from every fourth pixel arrives."""

    schedule = Schedule.FIRST
    inputs = *SURFACE, LIGHT_BUFFER, TLAS, LIGHT_INFLUENCE, Change.VIEW, Change.LIGHTS
    outputs = outputs(PROBES)

    def needed(self, frame: Frame) -> bool:
        return frame.casts_shadows

    def execute(self, frame: Frame) -> None:
        gl, casts = self.device.gl, frame.scene.lights.casts_shadow
        influences = frame[LIGHT_INFLUENCE]
        lights = [light for light, influence in influences.items() if casts[light] and influence.to_probe.any()]
        probes = {light: create(gl, PROBE, size_of(PROBE, *frame.size)) for light in lights}
        gl.enable_only(moderngl.NOTHING)
        light_uvs = rd_sequence(0, len(casts), 2)
        for light in lights:
            into = gl.framebuffer([probes[light]])
            into.clear()
            constants: dict[str, Any] = {"probe_spacing": PROBE_SPACING, **shader_variant(frame.scene.lights, light)}
            program = self.tile_program(*RECORDS, **constants)
            bind(
                program,
                **surface_samplers(frame),
                lights=frame[LIGHT_BUFFER],
                light_index=light,
                pixel_offset=(0, 0),
                pixel_steps=fixed_point(PIXEL_INCREMENTS),
                light_uv=fixed_point(light_uvs[light]),
                **frame[TLAS],
            )
            draw_tiles(frame, into, program, tiles_where(influences[light].to_probe), side=PROBES_PER_TILE_SIDE)
        frame[PROBES] = probes
