# SPDX-License-Identifier: GPL-3.0-or-later
"""A first look at what each light reaches: one shadow ray from every fourth pixel."""

import moderngl
import numpy as np

from ...sampling import PIXEL_STEPS, additive_sequence
from ...scene import Change
from ..context import Device
from ..layout import CASTER, LIGHT
from ..program import bind
from ..targets import Target
from . import SCOUTS_APART, Frame, Pass

#: Of each light: rays that arrived, and rays.
SCOUTED = Target(2, "f1", divisor=SCOUTS_APART)


class Scout(Pass):
    """For each light that casts shadows, whether a ray from every fourth pixel arrives."""

    reads = ("position", "normal", "albedo", "lights", "casters")
    makes = ("scouted",)
    depends_on = (Change.VIEW, Change.LIGHTS)

    def __init__(self, device: Device):
        super().__init__(device)
        self.pixels = self.full_screen(LIGHT, CASTER, scouts_apart=SCOUTS_APART)

    def needed(self, frame: Frame) -> bool:
        return frame.traces and frame.sample == 0

    def draw(self, frame: Frame) -> None:
        gl, view = self.device.gl, frame.view
        size = -(-view.width // SCOUTED.divisor), -(-view.height // SCOUTED.divisor)
        lights = np.flatnonzero(frame.scene.lights.casts_shadow)
        frame.tables["scouted"] = {light: SCOUTED.create(gl, size) for light in lights}
        gl.enable_only(moderngl.NOTHING)
        for light, place in zip(lights, additive_sequence(0, len(lights), 2), strict=True):
            gl.framebuffer([frame.tables["scouted"][light]]).use()
            bind(
                self.pixels.program,
                position=frame.targets["position"],
                normals=frame.targets["normal"],
                albedo=frame.targets["albedo"],
                triangles=frame.targets["triangle"],
                lights=frame.tables["lights"],
                light_index=light,
                pixel_steps=PIXEL_STEPS,
                place=tuple(place),
                **frame.tables["casters"],
            )
            self.pixels.render(moderngl.TRIANGLES, vertices=3)
