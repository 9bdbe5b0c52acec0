# SPDX-License-Identifier: GPL-3.0-or-later
"""The image of all samples so far: the mean of the predictions, plus the mean of the residuals, shrunk.

Residuals are multiplied by 1 - noise / mean square of their neighbourhood (James & Stein 1961). That is near 0 while
noise dominates and tends to 1, so the prediction's error vanishes in the limit.
"""

from functools import cached_property
from typing import ClassVar

import moderngl
import numpy as np

from ....resource_types import Target
from ....resources import (
    IMAGE,
    NEIGHBOUR_MEAN,
    SIGNAL_AND_NOISE,
    SUM_COLOR,
    SUM_HEADROOM,
    SUM_RESIDUAL,
    SUM_WEIGHTS,
)
from ....resources.world import (
    OCCLUSION_IMAGE,
    SUM_OCCLUSION,
    SUM_OCCLUSION_HEADROOM,
    SUM_OCCLUSION_RESIDUAL,
    SUM_OCCLUSION_WEIGHTS,
)
from ....scene import Change, Lights
from ...drawing import draw_pixels
from ...frame import Frame, Pass, outputs
from ...gl.shader_compiler import bind

#: Stratified samples have less variance than independent ones, by this power of the number of rays. Chosen by the error
#: of the scenes objects, lamps, atrium and thin of `bench error` at 4 to 16 samples.
STRATIFICATION_EXPONENT = 0.4

#: Sharpness of the weight that neighbours have by similarity of mean predicted luminance. At edges of surfaces this
#: distinguishes better than the last sample's positions and normals. See `dev.py bench constants`.
SIMILARITY_SHARPNESS = 20.0


class Resolve(Pass):
    """The sums as one image."""

    SUMS: ClassVar[tuple[Target, ...]] = SUM_COLOR, SUM_RESIDUAL, SUM_WEIGHTS, SUM_HEADROOM
    RESULT: ClassVar[Target] = IMAGE
    inputs = SUM_COLOR, SUM_RESIDUAL, SUM_WEIGHTS, SUM_HEADROOM, Change.SAMPLE
    outputs = outputs(NEIGHBOUR_MEAN, SIGNAL_AND_NOISE, IMAGE)

    @cached_property
    def neighbours(self) -> moderngl.VertexArray:
        return self.full_screen_program(
            suffix="neighbours",
            stratification_exponent=STRATIFICATION_EXPONENT,
            similarity_sharpness=SIMILARITY_SHARPNESS,
        )

    @cached_property
    def without_residual(self) -> moderngl.VertexArray:
        return self.full_screen_program(has_residual=0)

    @cached_property
    def with_residual(self) -> moderngl.VertexArray:
        return self.full_screen_program(has_residual=1)

    def execute(self, frame: Frame) -> None:
        self.device.overwrite()
        color, residual, weights, headroom = self.SUMS
        sums = {
            "sum_color": frame[color],
            "sum_residual": frame[residual],
            "sum_weights": frame[weights],
        }
        if frame.sample > 0:  # the first one has no residual
            # The neighbours' mean residual; squares of it and of the difference from it, with their noise.
            bind(self.neighbours.program, **sums)
            draw_pixels(frame, frame.framebuffer(NEIGHBOUR_MEAN, SIGNAL_AND_NOISE), self.neighbours)
        shader = self.with_residual if frame.sample > 0 else self.without_residual
        bind(
            shader.program,
            **sums,
            sum_headroom=frame[headroom],
            neighbour_mean=frame[NEIGHBOUR_MEAN],
            signal_and_noise=frame[SIGNAL_AND_NOISE],
            min_light=min_light(frame.scene.lights),
        )
        draw_pixels(frame, frame.framebuffer(self.RESULT), shader)


class ResolveOcclusion(Resolve):
    """The sums of the render pass AO as one image."""

    SUMS = SUM_OCCLUSION, SUM_OCCLUSION_RESIDUAL, SUM_OCCLUSION_WEIGHTS, SUM_OCCLUSION_HEADROOM
    RESULT = OCCLUSION_IMAGE
    inputs = *SUMS, Change.SAMPLE
    outputs = outputs(NEIGHBOUR_MEAN, SIGNAL_AND_NOISE, OCCLUSION_IMAGE)


def min_light(lights: Lights) -> float:
    """Minimum luminance of a pixel: 0, or no bound if there are negative lights."""
    return -float(np.finfo(np.float32).max) if (lights.emission < 0.0).any() else 0.0
