# SPDX-License-Identifier: GPL-3.0-or-later
"""The error of each tile, from the difference between the image and the image of half as many samples.

See convergence.py for the derivation. Tiles whose error is below the threshold have converged.
"""

from functools import cached_property

import moderngl
import numpy as np

from ....resources import (
    CONVERGENCE,
    DOUBLING_DIFFERENCE,
    HALF_SAMPLES_IMAGE,
    IMAGE,
    SAMPLES_PER_TILE,
    TILE_SIZE,
)
from ....scene import Change
from ...convergence import Convergence
from ...drawing import draw_per_tile
from ...frame import Frame, Pass, has_doubled, outputs
from ...tiles import from_strips

#: Samples before which no tile converges: features narrower than this many samples resolve would be missed. It is the
#: default number of samples of a viewport.
MIN_SAMPLES_TO_STOP = 16

FLOAT32_TINY = float(np.finfo(np.float32).tiny)


def is_due(sample: int, samples: int) -> bool:
    """Whether the error is estimated after this sample: when the number of samples has doubled.

    After the first sample, the earliest is half of MIN_SAMPLES_TO_STOP, as no tile can converge before, or half of
    `samples` if that is less. Tiles that get no sample in a doubling keep their earlier estimate.
    """
    count = sample + 1
    return has_doubled(count) and (sample == 0 or 4 * count > min(samples, MIN_SAMPLES_TO_STOP))


class EstimateError(Pass):
    """The error of each tile, whenever samples have doubled, and which tiles have converged."""

    inputs = IMAGE, SAMPLES_PER_TILE, Change.SAMPLE, "quality.error_threshold", "shortcuts"
    outputs = outputs(CONVERGENCE, HALF_SAMPLES_IMAGE, DOUBLING_DIFFERENCE)

    @cached_property
    def tile_shader(self) -> moderngl.VertexArray:
        return self.full_screen_program(tile_size=TILE_SIZE)

    def execute(self, frame: Frame) -> None:
        counts, quality = frame[SAMPLES_PER_TILE], frame.settings.quality
        convergence = Convergence(counts.shape) if frame.sample == 0 else frame[CONVERGENCE]
        convergence.counts = counts
        if is_due(frame.sample, quality.samples):
            if frame.sample > 0:
                convergence.update(self.squared_difference(frame))
            frame.copy_target(HALF_SAMPLES_IMAGE, IMAGE)
            convergence.half_counts = counts
        if frame.settings.shortcuts and quality.error_threshold > 0.0 and frame.sample + 1 >= MIN_SAMPLES_TO_STOP:
            convergence.stop_below(quality.error_threshold)
        frame[CONVERGENCE] = convergence

    def squared_difference(self, frame: Frame) -> np.ndarray:
        """(rows,columns): mean squared differences of tiles, divided by the square of the image's mean luminance."""
        images = {"image": frame[IMAGE], "half_samples_image": frame[HALF_SAMPLES_IMAGE]}
        self.device.overwrite()
        draw_per_tile(frame, frame.framebuffer(DOUBLING_DIFFERENCE), self.tile_shader, **images)
        self.device.wait()
        texels = from_strips(frame.read(DOUBLING_DIFFERENCE), frame.tiles)
        square, luminance = np.moveaxis(texels, -1, 0)
        return square / max(float(luminance.mean()) ** 2, FLOAT32_TINY)
