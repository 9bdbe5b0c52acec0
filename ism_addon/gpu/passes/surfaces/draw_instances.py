# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws instances in the visibility buffer's finer grid."""

import math
from typing import Any

import moderngl
import numpy as np

from ....resources import INSTANCE_BUFFERS, MESH_BUFFERS
from ...buffers.instance_buffers import MultiDrawCall, portions
from ...frame import Frame
from ...gl.depth import logarithm, nearness
from ...gl.frame_uniforms import clip_from_anchor
from ...gl.shader_compiler import bind
from ...materials.point_graphs import PointGraphs

#: OpenGL clips triangles at this distance outside the picture, as a fraction of its sides: it clips very large
#: triangles imprecisely.
GUARD_BAND = 0.125

#: Triangles per submission. A software driver shades them on all cores while it transforms the next ones, and doesn't
#: need memory for all triangles at once.
TRIANGLES_AT_A_TIME = 1 << 16


def fine_size(frame: Frame) -> tuple[int, int]:
    """Columns and rows of the finer grid."""
    width, height = map(int, frame.grid.bounds(*frame.size)[1])
    return width, height


def instances_in_view(frame: Frame) -> np.ndarray:
    """(I,) bool: the rows of INSTANCE_BUFFERS that are to be drawn."""
    instances = frame[INSTANCE_BUFFERS]
    if not frame.settings.shortcuts:
        return np.ones(len(instances.mesh), np.bool_)
    pixel = 2.0 / min(frame.size)
    return instances.in_view(clip_from_anchor(frame.view, frame.anchor), pixel)


def draw_instances(
    frame: Frame,
    framebuffer: moderngl.Framebuffer,
    program: moderngl.Program,
    surfaces: PointGraphs,
    is_drawn: np.ndarray,
    **uniforms: Any,
) -> None:
    """Draw the instances where `is_drawn` (I,) is true, by an instance_program for opaque or transparent surfaces."""
    device, instances, size = frame.device, frame[INSTANCE_BUFFERS], fine_size(frame)
    max_side = device.texture_size  # also the limit of viewports
    guard_band = [min(math.ceil(GUARD_BAND * side), (max_side - side) // 2) for side in size]
    framebuffer.viewport = *np.negative(guard_band), *np.add(size, np.multiply(2, guard_band))
    framebuffer.use()
    viewport_fraction = np.divide(size, framebuffer.viewport[2:])
    rotation, shift = frame.grid.fine_from_clip(*frame.size)
    bind(
        program,
        rotation=tuple((viewport_fraction[:, None] * rotation).T.ravel()),
        shift=tuple(viewport_fraction * shift),
        depth=(nearness if device.reversed_depth else logarithm)(frame.view.clip_from_view),
        corners=frame[MESH_BUFFERS].samplers["corners"],
        owners=instances.owners.texture,
        **{"instances": instances.table, **surfaces.uniforms},
        **uniforms,
    )
    vertices, unsubmitted = device.gl.vertex_array(program, []), 0
    for draw_call in portions(instances.draw_calls(is_drawn), TRIANGLES_AT_A_TIME):
        bind(program, is_multi_draw=isinstance(draw_call, MultiDrawCall))
        if isinstance(draw_call, MultiDrawCall):
            count = int(draw_call.triangles.sum())
            device.draw_ranges(vertices, draw_call.first_triangle, draw_call.triangles)
        else:
            count = draw_call.triangles * draw_call.instances
            bind(program, first_instance=draw_call.first_instance)
            device.draw(vertices, draw_call.first_triangle, draw_call.triangles, draw_call.instances)
        frame.counts["triangles_drawn"] += count
        unsubmitted += count
        if unsubmitted >= TRIANGLES_AT_A_TIME:
            frame.submission.submit()
            unsubmitted = 0
