# SPDX-License-Identifier: GPL-3.0-or-later
"""A close look at what each light reaches: one shadow ray from every fourth pixel, where CullLights asks for it."""

from dataclasses import asdict

import moderngl

from ....sampling import PIXEL_INCREMENTS, fixed_point, rd_sequence
from ....scene import Change
from ...frame import PROBE_SPACING, PROBES, PROBES_PER_TILE_SIDE, Frame, Pass, tiles_where
from ...gl.shader_compiler import bind
from ..direct.ray_correction import RECORDS, LightVariant


class ProbeVisibility(Pass):
    """For each light that casts shadows and may be seen, whether a ray from every fourth pixel arrives."""

    reads = ("position", "normal", "placement", "rise", "lights", "casters", "reach")
    makes = ("scouted",)
    depends_on = (Change.VIEW, Change.LIGHTS)

    def needed(self, frame: Frame) -> bool:
        return frame.traces and frame.sample == 0

    def draw(self, frame: Frame) -> None:
        gl, view = self.device.gl, frame.view
        size = PROBES.size(view.width, view.height)
        casts = frame.scene.lights.casts_shadow
        lights = [light for light, to in frame.tables["reach"].items() if casts[light] and to.scouted.any()]
        scouted = {light: PROBES.create(gl, size) for light in lights}
        gl.enable_only(moderngl.NOTHING)
        places = rd_sequence(0, len(casts), 2)
        for light in lights:
            into = gl.framebuffer([scouted[light]])
            into.clear()
            kind = LightVariant.of(frame.scene.lights, light)
            program = self.tile_program(*RECORDS, probe_spacing=PROBE_SPACING, **asdict(kind))
            bind(
                program,
                **frame.receivers,
                lights=frame.tables["lights"],
                light_index=light,
                offset=(0, 0),
                pixel_steps=fixed_point(PIXEL_INCREMENTS),
                place=fixed_point(places[light]),
                **frame.tables["casters"],
            )
            blocks = tiles_where(frame.tables["reach"][light].scouted)
            self.draw_tiles(frame, into, program, blocks, block=PROBES_PER_TILE_SIDE)
        frame.tables["scouted"] = scouted
