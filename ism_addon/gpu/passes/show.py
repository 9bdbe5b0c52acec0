# SPDX-License-Identifier: GPL-3.0-or-later
"""Any target as a picture: what settings.show names, stretched to the picture's size."""

from functools import cached_property

import moderngl

from ..program import bind, compile_program
from ..targets import Target
from . import Frame, Pass


class Show(Pass):
    """The picture that is accumulated: the colour, or a target looked into."""

    reads = ("color",)
    writes = {"shown": Target(4, "f4")}
    settings = ("show",)

    @cached_property
    def pixels(self) -> dict[bool, moderngl.VertexArray]:
        programs = {
            integers: compile_program(self.device, "full_screen.vert", "show.frag", integers=int(integers))
            for integers in (False, True)
        }
        return {integers: self.device.gl.vertex_array(program, []) for integers, program in programs.items()}

    def needed(self, frame: Frame) -> bool:
        return frame.settings.show != "color"

    def draw(self, frame: Frame) -> None:
        frame.device.gl.enable_only(moderngl.NOTHING)
        source = frame.targets[frame.settings.show]
        pixels = self.pixels[source.dtype == "u4"]
        bind(
            pixels.program,
            source=source,
            octahedral=frame.settings.show == "normal",
            components=source.components,
            size=frame.targets.sizes[frame.settings.show],
        )
        self.draw_pixels(frame, frame.targets.into("shown"), pixels)
