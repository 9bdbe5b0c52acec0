# SPDX-License-Identifier: GPL-3.0-or-later
"""A target as an image: the debug view of the settings, stretched to the picture's size."""

from functools import cached_property

import moderngl

from ....resource_types import targets_of
from ....resources import DEBUG_IMAGE, DEBUG_VIEWS, PRIMITIVE, SAMPLE_COLOR
from ....sampling.dimensions import Dimension, fixed_increments
from ...drawing import draw_pixels
from ...frame import Frame, Pass, outputs
from ...gl.shader_compiler import bind, compile_program


class DebugImage(Pass):
    """The debug view."""

    inputs = *DEBUG_VIEWS, "debug_view"
    outputs = outputs(DEBUG_IMAGE)

    @cached_property
    def shaders(self) -> dict[bool, moderngl.VertexArray]:
        stages = "glsl/full_screen.vert", f"{self.shader_name()}.frag"
        programs = {
            integers: compile_program(self.device, *stages, integers=int(integers)) for integers in (False, True)
        }
        return {integers: self.device.gl.vertex_array(program, []) for integers, program in programs.items()}

    def needed(self, frame: Frame) -> bool:
        return frame.settings.debug_view != SAMPLE_COLOR.name

    def execute(self, frame: Frame) -> None:
        frame.device.overwrite()
        view = next(view for view in DEBUG_VIEWS if view.name == frame.settings.debug_view)
        source, (target,) = frame[view], targets_of([view])
        shader = self.shaders[source.dtype == "u4"]
        bind(
            shader.program,
            source=source,
            primitive=view is PRIMITIVE,
            components=source.components,
            triangle_steps=fixed_increments(Dimension.DEBUG_COLOR, "triangle"),
            instance_steps=fixed_increments(Dimension.DEBUG_COLOR, "instance"),
            size=(1, 1) if frame.is_neutral(target) else frame.graph.targets.sizes[target],
        )
        draw_pixels(frame, frame.framebuffer(DEBUG_IMAGE), shader)
