# SPDX-License-Identifier: GPL-3.0-or-later
"""The visible triangle at each sample position: a visibility buffer (Burns & Hunt 2013).

Triangles are drawn with only their positions and indices. GBuffer fetches the other attributes, once per pixel. The
buffer has a higher resolution than the image, so that several samples share it.
"""

import math

import moderngl
import numpy as np

from ....resources import INSTANCE_BUFFERS, MESH_BUFFERS, VISIBILITY_BUFFER, VISIBILITY_DEPTH
from ....scene import Change
from ...buffers.instance_buffers import MultiDrawCall, portions
from ...frame import Frame, Pass, outputs
from ...gl.context import Device
from ...gl.depth import logarithm, nearness
from ...gl.frame_uniforms import clip_from_anchor
from ...gl.shader_compiler import bind, compile_program
from ...gl.shader_records import INSTANCE

#: OpenGL clips triangles at this distance outside the picture, as a fraction of its sides: it clips very large
#: triangles imprecisely.
GUARD_BAND = 0.125

#: Triangles per submission. A software driver shades them on all cores while it transforms the next ones, and doesn't
#: need memory for all triangles at once.
TRIANGLES_AT_A_TIME = 1 << 16


class VisibilityBuffer(Pass):
    """The nearest triangle and its instance; 0 where there is none."""

    inputs = MESH_BUFFERS, INSTANCE_BUFFERS, Change.VIEW, Change.PIXEL_GRID, "shortcuts"
    outputs = outputs(VISIBILITY_BUFFER, VISIBILITY_DEPTH)

    def __init__(self, device: Device):
        super().__init__(device)
        stages = (f"passes/surfaces/visibility_buffer.{stage}" for stage in ("vert", "frag"))
        self.program = compile_program(device, *stages, records=(INSTANCE,), reversed_depth=int(device.reversed_depth))

    def execute(self, frame: Frame) -> None:
        gl = frame.device.gl
        width, height = map(int, frame.grid.bounds(*frame.size)[1])
        size = width, height
        max_columns, max_rows = map(int, np.minimum(frame.grid.max_size(*frame.size), self.device.texture_size))
        for target in (VISIBILITY_BUFFER, VISIBILITY_DEPTH):
            frame.reserve(target, (max_columns, max_rows))
        framebuffer = frame.framebuffer(VISIBILITY_BUFFER, VISIBILITY_DEPTH)
        framebuffer.clear(depth=0.0, viewport=(0, 0, *size))
        max_side = self.device.texture_size  # also the limit of viewports
        guard_band = [min(math.ceil(GUARD_BAND * side), (max_side - side) // 2) for side in size]
        framebuffer.viewport = *np.negative(guard_band), *np.add(size, np.multiply(2, guard_band))
        framebuffer.use()
        self.device.enable_only(moderngl.DEPTH_TEST)
        rotation, shift = frame.grid.fine_from_clip(*frame.size)
        viewport_fraction = np.divide(size, framebuffer.viewport[2:])
        instances = frame[INSTANCE_BUFFERS]
        bind(
            self.program,
            rotation=tuple((viewport_fraction[:, None] * rotation).T.ravel()),
            shift=tuple(viewport_fraction * shift),
            depth=(nearness if self.device.reversed_depth else logarithm)(frame.view.clip_from_view),
            corners=frame[MESH_BUFFERS].samplers["corners"],
            instances=instances.table,
            owners=instances.owners.texture,
        )
        if frame.settings.shortcuts:
            pixel = 2.0 / min(frame.size)
            draws = instances.visible_draw_calls(clip_from_anchor(frame.view, frame.anchor), pixel)
        else:
            draws = instances.draw_calls(np.ones(len(instances.mesh), np.bool_))
        vertices, unsubmitted = gl.vertex_array(self.program, []), 0
        for draw in portions(draws, TRIANGLES_AT_A_TIME):
            bind(self.program, is_multi_draw=isinstance(draw, MultiDrawCall))
            if isinstance(draw, MultiDrawCall):
                count = int(draw.triangles.sum())
                self.device.draw_ranges(vertices, draw.first_triangle, draw.triangles)
            else:
                count = draw.triangles * draw.instances
                bind(self.program, first_instance=draw.first_instance)
                self.device.draw(vertices, draw.first_triangle, draw.triangles, draw.instances)
            frame.counts["triangles_drawn"] += count
            unsubmitted += count
            if unsubmitted >= TRIANGLES_AT_A_TIME:
                frame.submission.submit()
                unsubmitted = 0
