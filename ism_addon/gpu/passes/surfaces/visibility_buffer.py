# SPDX-License-Identifier: GPL-3.0-or-later
"""The visible triangle at each sample position: a visibility buffer (Burns & Hunt 2013).

Triangles are drawn with only their positions and indices. GBuffer fetches the other attributes, once per pixel. The
buffer has a higher resolution than the image, so that several samples share it.
"""

import math
from typing import Any

import moderngl
import numpy as np

from ....resources import (
    INSTANCE_BUFFERS,
    MESH_BUFFERS,
    POINT_GRAPHS,
    VISIBILITY_BUFFER,
    VISIBILITY_DEPTH,
)
from ....sampling.dimensions import Dimension, draw, fixed_point
from ....scene import Change
from ...buffers.instance_buffers import MultiDrawCall, portions
from ...frame import Frame, Pass, outputs
from ...gl.depth import logarithm, nearness
from ...gl.frame_uniforms import clip_from_anchor
from ...gl.shader_compiler import bind, compile_program
from ...gl.shader_records import INSTANCE
from ...materials.point_graphs import NO_POINT_GRAPHS, OPAQUE, PointGraphs

#: OpenGL clips triangles at this distance outside the picture, as a fraction of its sides: it clips very large
#: triangles imprecisely.
GUARD_BAND = 0.125

#: Triangles per submission. A software driver shades them on all cores while it transforms the next ones, and doesn't
#: need memory for all triangles at once.
TRIANGLES_AT_A_TIME = 1 << 16


#: Strata of the random numbers by which transparent surfaces are drawn.
STRATA = 16


class VisibilityBuffer(Pass):
    """The nearest triangle and its instance; 0 where there is none."""

    inputs = MESH_BUFFERS, INSTANCE_BUFFERS, POINT_GRAPHS, Change.VIEW, Change.PIXEL_GRID, "shortcuts"
    outputs = outputs(VISIBILITY_BUFFER, VISIBILITY_DEPTH)

    def execute(self, frame: Frame) -> None:
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
        viewport_fraction = np.divide(size, framebuffer.viewport[2:])
        instances, camera = frame[INSTANCE_BUFFERS], (frame.get(POINT_GRAPHS) or NO_POINT_GRAPHS).camera
        if frame.settings.shortcuts:
            pixel = 2.0 / min(frame.size)
            is_drawn = instances.in_view(clip_from_anchor(frame.view, frame.anchor), pixel)
        else:
            is_drawn = np.ones(len(instances.mesh), np.bool_)
        passes = np.zeros(len(is_drawn), np.bool_)
        if camera is not OPAQUE:
            passes = instances.with_materials(frame.scene.materials.transparency[:, 0] >= 0)
        self.draw(frame, OPAQUE, is_drawn & ~passes, viewport_fraction)
        if (is_drawn & passes).any():  # afterwards, as fewer of its pixels are visible then
            self.draw(frame, camera, is_drawn & passes, viewport_fraction)

    def draw(self, frame: Frame, surfaces: PointGraphs, is_drawn: np.ndarray, viewport_fraction: np.ndarray) -> None:
        """Draw the instances where `is_drawn` (I,) is true, with a program for opaque or for transparent surfaces."""
        program, instances = self.program(surfaces), frame[INSTANCE_BUFFERS]
        rotation, shift = frame.grid.fine_from_clip(*frame.size)
        bind(
            program,
            rotation=tuple((viewport_fraction[:, None] * rotation).T.ravel()),
            shift=tuple(viewport_fraction * shift),
            depth=(nearness if self.device.reversed_depth else logarithm)(frame.view.clip_from_view),
            corners=frame[MESH_BUFFERS].samplers["corners"],
            owners=instances.owners.texture,
            **{"instances": instances.table, **surfaces.uniforms},
            **({} if surfaces is OPAQUE else strata(frame)),
        )
        vertices, unsubmitted = self.device.gl.vertex_array(program, []), 0
        for draw_call in portions(instances.draw_calls(is_drawn), TRIANGLES_AT_A_TIME):
            bind(program, is_multi_draw=isinstance(draw_call, MultiDrawCall))
            if isinstance(draw_call, MultiDrawCall):
                count = int(draw_call.triangles.sum())
                self.device.draw_ranges(vertices, draw_call.first_triangle, draw_call.triangles)
            else:
                count = draw_call.triangles * draw_call.instances
                bind(program, first_instance=draw_call.first_instance)
                self.device.draw(vertices, draw_call.first_triangle, draw_call.triangles, draw_call.instances)
            frame.counts["triangles_drawn"] += count
            unsubmitted += count
            if unsubmitted >= TRIANGLES_AT_A_TIME:
                frame.submission.submit()
                unsubmitted = 0

    def program(self, surfaces: PointGraphs) -> moderngl.Program:
        """The program for such surfaces."""
        stages = (f"passes/surfaces/visibility_buffer.{stage}" for stage in ("vert", "frag"))
        return compile_program(
            self.device,
            *stages,
            *surfaces.includes,
            records=surfaces.records or (INSTANCE,),
            reversed_depth=int(self.device.reversed_depth),
            **surfaces.constants,
        )


def strata(frame: Frame) -> dict[str, Any]:
    """Uniforms that number a pixel's samples, for random numbers that are stratified over each STRATA of them."""
    grid = frame.grid
    fine_from_pixel, count = grid.fine_from_pixel, len(grid.texels)
    # Numbers of the fine pixels in a pixel are x, plus y times the factor, modulo their count.
    multiples = (fine_from_pixel[0] + np.arange(count)[:, None] * fine_from_pixel[1]) % count
    factor = int(np.flatnonzero(~multiples.any(1))[0])
    numbers = (grid.texels @ (1, factor)) % count
    digits = sum(index << 4 * number for index, number in enumerate(numbers.tolist()))
    first, _ = grid.bounds(*frame.size)
    begin = frame.sample // count * count
    (seed,) = fixed_point(draw(Dimension.TRANSPARENCY, round=begin // STRATA))
    return {
        "pixel_from_fine": tuple(np.linalg.inv(fine_from_pixel).T.ravel()),
        "first": tuple(first),
        "strata": (count, factor, begin % STRATA),
        "sample_digits": (digits & 0xFFFFFFFF, digits >> 32),
        "round_seed": seed,
    }
