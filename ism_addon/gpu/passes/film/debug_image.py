# SPDX-License-Identifier: GPL-3.0-or-later
"""Any target as a picture: what settings.debug_view names, stretched to the picture's size."""

from functools import cached_property

import moderngl

from ...frame import Frame, Pass
from ...gl.render_targets import Target
from ...gl.shader_compiler import bind, compile_program


class DebugImage(Pass):
    """The picture that is accumulated: the colour, or a target looked into."""

    reads = ("color",)
    writes = {"shown": Target(4, "f4")}
    settings = ("debug_view",)

    @cached_property
    def pixels(self) -> dict[bool, moderngl.VertexArray]:
        stages = "glsl/full_screen.vert", f"{self.name_of()}.frag"
        programs = {
            integers: compile_program(self.device, *stages, integers=int(integers)) for integers in (False, True)
        }
        return {integers: self.device.gl.vertex_array(program, []) for integers, program in programs.items()}

    def needed(self, frame: Frame) -> bool:
        return frame.settings.debug_view != "color"

    def draw(self, frame: Frame) -> None:
        frame.device.gl.enable_only(moderngl.NOTHING)
        source = frame.targets[frame.settings.debug_view]
        pixels = self.pixels[source.dtype == "u4"]
        bind(
            pixels.program,
            source=source,
            octahedral=frame.settings.debug_view == "normal",
            components=source.components,
            size=frame.targets.sizes[frame.settings.debug_view],
        )
        self.draw_pixels(frame, frame.targets.into("shown"), pixels)
