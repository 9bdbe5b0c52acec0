# SPDX-License-Identifier: GPL-3.0-or-later
"""Screen-space ambient occlusion at half resolution, in two ways.

By horizons: how much of a cone about the normal the visible surfaces within a radius hide, see ambient_occlusion.frag.
Neighbouring pixels have different slices, evenly distributed, which the blur averages.

By points, as in Beck-Norén & Valter 2013, sections 2.2 and 3.3, after Mittring 2007: points within a radius and a cone
about the normal are projected to the screen. A point behind the visible surface there is occluded. Most points are near
the receiver, so this is too faint beside rays of the same radius.

A tiled 64×64 random texture rotates the points from pixel to pixel. Both weight by the cosine, and attenuate by the
occluder's distance. Each sample has other directions.
"""

from functools import cached_property
from typing import Any, cast

import moderngl
import numpy as np

from ....choices import OcclusionSampling, RadiusUnit
from ....resources import DEPTH, INSTANCE_BUFFERS, NORMAL, POSITION
from ....resources.world import RAW_OCCLUSION
from ....sampling.dimensions import Dimension, draw, fixed_increments, fixed_point, white_noise
from ....scene import Change
from ...drawing import draw_pixels
from ...frame import Frame, Pass, outputs
from ...gl import driver_variants
from ...gl.frame_uniforms import clip_from_anchor
from ...gl.shader_compiler import bind
from ...occlusion import is_needed, radius_uniforms

#: Side of the random texture, as in the report.
NOISE_SIZE = 64

#: Points per pixel and sample, about as many as in the report; steps to each side of a slice, as many taps. One slice
#: of eight steps has less error than two of four, if slices are weighted relative to the mean of all.
POINTS = 16
STEPS_TO_A_SIDE = 8

#: px. Points closer than this to a pixel's centre, in x and in y, are in the pixel, with a margin for rounding.
SUBPIXEL_RADIUS = 0.49


class AmbientOcclusion(Pass):
    """The visible fraction of the cone about each pixel's normal: 1 is open."""

    inputs = DEPTH, POSITION, NORMAL, INSTANCE_BUFFERS, Change.VIEW, Change.SAMPLE, "ssao"
    outputs = outputs(RAW_OCCLUSION)

    @cached_property
    def horizons(self) -> moderngl.VertexArray:
        return self.full_screen_program(steps_to_a_side=STEPS_TO_A_SIDE)

    @cached_property
    def points(self) -> moderngl.VertexArray:
        directions = draw(Dimension.OCCLUSION, direction=np.arange(POINTS))
        pixels = self.full_screen_program(suffix="points", points=POINTS, tile=NOISE_SIZE)
        cast(moderngl.Uniform, pixels.program["directions"]).write(directions.astype("f4"))
        return pixels

    @cached_property
    def random(self) -> moderngl.Texture:
        random = white_noise(Dimension.OCCLUSION, (NOISE_SIZE, NOISE_SIZE, 2))
        texture = self.device.gl.texture((NOISE_SIZE, NOISE_SIZE), 2, random, dtype="f4")
        driver_variants.never_filtered(texture)
        return texture

    def needed(self, frame: Frame) -> bool:
        ssao = frame.settings.ssao
        if ssao.sampling is OcclusionSampling.TRACED or not is_needed(frame):
            return False
        in_pixels = ssao.unit is RadiusUnit.PIXELS
        pixels = ssao.radius_pixels if in_pixels else projected_radius(frame, ssao.radius)
        return not (frame.settings.shortcuts and pixels < SUBPIXEL_RADIUS)

    def execute(self, frame: Frame) -> None:
        ssao = frame.settings.ssao
        if ssao.sampling is OcclusionSampling.HORIZONS:
            shader = self.horizons
            uniforms: dict[str, Any] = {
                "cone_cosine": np.cos(ssao.cone_angle / 2.0),
                "thickness": ssao.thickness,
                "pixel_steps": fixed_increments(Dimension.OCCLUSION_SLICE, "pixel"),
                "turn_shift": fixed_point(draw(Dimension.OCCLUSION_SLICE, sample=frame.sample)),
            }
        else:
            shader = self.points
            uniforms = {
                "cone_sine": np.sin(ssao.cone_angle / 2.0),
                "depth": frame[DEPTH],
                "random": self.random,
                "rotation": tuple(draw(Dimension.OCCLUSION_ROTATION, sample=frame.sample)),
            }
        frame.device.overwrite()
        bind(
            shader.program,
            **uniforms,
            position=frame[POSITION],
            normal=frame[NORMAL],
            **radius_uniforms(frame),
            attenuation=ssao.attenuation,
        )
        draw_pixels(frame, frame.framebuffer(RAW_OCCLUSION), shader)


def projected_radius(frame: Frame, radius: float) -> float:
    """Upper bound, px in x or y, of the projected distance of visible points to points within `radius` m of them."""
    instances, clip = frame[INSTANCE_BUFFERS], clip_from_anchor(frame.view, frame.anchor)
    x, y, w = np.linalg.norm(clip[[0, 1, 3], :3], axis=1)
    w_of_boxes = clip[3, :3] @ instances.matrices
    min_w = w_of_boxes[:, 3] + clip[3, 3] - np.einsum("nj,nj->n", np.abs(w_of_boxes[:, :3]), instances.half_sizes)
    nearest = min_w.min(initial=np.inf) - radius * w
    if nearest <= 0.0:
        return float(np.inf)
    # A visible point is at most half a picture from its centre, so a change of depth moves it by that at most.
    return float(radius / nearest * max((x + w) * frame.view.width, (y + w) * frame.view.height) / 2.0)
