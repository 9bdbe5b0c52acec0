# SPDX-License-Identifier: GPL-3.0-or-later
"""The visible triangle at each sample position: a visibility buffer (Burns & Hunt 2013).

Triangles are drawn with their positions and indices alone. GBuffer fetches the rest, once a pixel. The grid is finer
than the pixels', so that several samples share one drawing.
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

#: OpenGL clips triangles this far beyond the picture, as a fraction of its sides: it clips vast triangles imprecisely.
GUARD_BAND = 0.125

#: Triangles that are submitted at a time. A software driver shades them on all cores while it transforms the next ones,
#: and needs no memory for all of them.
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
        most_columns, most_rows = map(int, np.minimum(frame.grid.max_size(*frame.size), self.device.texture_size))
        for target in (VISIBILITY_BUFFER, VISIBILITY_DEPTH):
            frame.reserve(target, (most_columns, most_rows))
        framebuffer = frame.framebuffer(VISIBILITY_BUFFER, VISIBILITY_DEPTH)
        framebuffer.clear(depth=0.0, viewport=(0, 0, *size))
        most = self.device.texture_size  # viewports may be as large
        beyond = [min(math.ceil(GUARD_BAND * side), (most - side) // 2) for side in size]
        framebuffer.viewport = *np.negative(beyond), *np.add(size, np.multiply(2, beyond))
        framebuffer.use()
        gl.enable_only(moderngl.DEPTH_TEST)
        rotation, shift = frame.grid.fine_from_clip(*frame.size)
        part = np.divide(size, framebuffer.viewport[2:])
        instances = frame[INSTANCE_BUFFERS]
        bind(
            self.program,
            rotation=tuple((part[:, None] * rotation).T.ravel()),
            shift=tuple(part * shift),
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
        vertices, waiting = gl.vertex_array(self.program, []), 0
        for draw in portions(draws, TRIANGLES_AT_A_TIME):
            bind(self.program, together=isinstance(draw, MultiDrawCall))
            if isinstance(draw, MultiDrawCall):
                count = int(draw.triangles.sum())
                self.device.draw_ranges(vertices, draw.first_triangle, draw.triangles)
            else:
                count = draw.triangles * draw.instances
                bind(self.program, first_instance=draw.first_instance)
                self.device.draw(vertices, draw.first_triangle, draw.triangles, draw.instances)
            frame.counts["triangles_drawn"] += count
            waiting += count
            if waiting >= TRIANGLES_AT_A_TIME:
                frame.submission.submit()
                waiting = 0
