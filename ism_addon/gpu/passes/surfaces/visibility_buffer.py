# SPDX-License-Identifier: GPL-3.0-or-later
"""The visible triangle at each sample position: a visibility buffer (Burns & Hunt 2013).

Triangles are drawn with only their positions and indices. GBuffer fetches the other attributes, once per pixel. The
buffer has a higher resolution than the image, so that several samples share it.
"""

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
from ...frame import Frame, Pass, outputs
from ...materials.point_graphs import NO_POINT_GRAPHS, OPAQUE
from .draw_instances import draw_instances, fine_size, instances_in_view

#: Strata of the random numbers by which transparent surfaces are drawn.
STRATA = 16


class VisibilityBuffer(Pass):
    """The nearest triangle and its instance; 0 where there is none."""

    inputs = MESH_BUFFERS, INSTANCE_BUFFERS, POINT_GRAPHS, Change.VIEW, Change.PIXEL_GRID, "shortcuts"
    outputs = outputs(VISIBILITY_BUFFER, VISIBILITY_DEPTH)

    def execute(self, frame: Frame) -> None:
        max_columns, max_rows = map(int, np.minimum(frame.grid.max_size(*frame.size), self.device.texture_size))
        for target in (VISIBILITY_BUFFER, VISIBILITY_DEPTH):
            frame.reserve(target, (max_columns, max_rows))
        framebuffer = frame.framebuffer(VISIBILITY_BUFFER, VISIBILITY_DEPTH)
        framebuffer.clear(depth=0.0, viewport=(0, 0, *fine_size(frame)))
        self.device.enable_only(moderngl.DEPTH_TEST)
        instances, camera = frame[INSTANCE_BUFFERS], (frame.get(POINT_GRAPHS) or NO_POINT_GRAPHS).camera
        is_drawn = instances_in_view(frame)
        passes = np.zeros(len(is_drawn), np.bool_)
        if camera is not OPAQUE:
            passes = instances.with_materials(frame.scene.materials.transparency[:, 0] >= 0)
        draw_instances(frame, framebuffer, self.instance_program(OPAQUE), OPAQUE, is_drawn & ~passes)
        if (is_drawn & passes).any():  # afterwards, as fewer of its pixels are visible then
            program = self.instance_program(camera)
            draw_instances(frame, framebuffer, program, camera, is_drawn & passes, **strata(frame))


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
