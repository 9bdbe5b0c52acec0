# SPDX-License-Identifier: GPL-3.0-or-later
"""The tint of what the camera sees through coloured transparent surfaces.

The visibility buffer leaves a surface out with the probability of the color component that passes best. So every
surface before the visible one has let a ray pass, and what is behind is multiplied by all components relative to that
one. The product does not depend on the order of the surfaces.
"""

import moderngl

from ....resources import INSTANCE_BUFFERS, MESH_BUFFERS, POINT_GRAPHS, TRANSMITTED_COLOR, VISIBILITY_DEPTH
from ....scene import Change
from ...frame import Frame, Pass, outputs
from .draw_instances import draw_instances, fine_size, instances_in_view

#: Where there is no such surface: no tint, and the lowest half-precision number in place of z.
NO_TINT = 1.0, 1.0, 1.0, -65504.0


class TransmittedColor(Pass):
    """The tint of what is seen through colored surfaces; in alpha, the view-space z of the nearest."""

    inputs = POINT_GRAPHS, MESH_BUFFERS, INSTANCE_BUFFERS, VISIBILITY_DEPTH, Change.VIEW, Change.PIXEL_GRID, "shortcuts"
    outputs = outputs(TRANSMITTED_COLOR)

    def needed(self, frame: Frame) -> bool:
        return bool(frame.scene.tints.any())

    def execute(self, frame: Frame) -> None:
        frame.allocate(TRANSMITTED_COLOR, frame.graph.targets.sizes[VISIBILITY_DEPTH])
        framebuffer = frame.framebuffer(TRANSMITTED_COLOR, VISIBILITY_DEPTH)
        framebuffer.depth_mask = False
        framebuffer.clear(*NO_TINT, viewport=(0, 0, *fine_size(frame)))
        is_drawn = instances_in_view(frame) & frame[INSTANCE_BUFFERS].with_materials(frame.scene.tints)
        gl, surfaces = self.device.gl, frame[POINT_GRAPHS].camera
        program = self.instance_program(surfaces)
        self.device.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        gl.blend_func = moderngl.DST_COLOR, moderngl.ZERO
        gl.blend_equation = moderngl.FUNC_ADD, moderngl.MAX
        try:
            draw_instances(frame, framebuffer, program, surfaces, is_drawn)
        finally:
            gl.blend_equation = moderngl.FUNC_ADD  # type: ignore[assignment] # typed as two values, accepts one
