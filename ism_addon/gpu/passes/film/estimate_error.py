# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture beside what it was at half as many samples: how far it moved says how far it is from its end.

See convergence.py for why. Blocks that are near enough take part in no further sample.
"""

from functools import cached_property

import moderngl
import numpy as np

from ....scene import Change
from ...frame import TILE_SIZE, Frame, Pass, from_tile_layout
from ...gl.context import Device
from ...gl.render_targets import Target

#: Samples before which no block is good enough: so many rays most things are met by, and as many a picture has by
#: default.
MIN_SAMPLES_TO_STOP = 16

FLOAT32_TINY = float(np.finfo(np.float32).tiny)


def is_due(sample: int, samples: int) -> bool:
    """Whether the number of samples has doubled with this one, since the last time that was worth a look.

    After the first sample that is half of MIN_SAMPLES_TO_STOP, as no tile can be good enough before; or of `samples`,
    if all are fewer. Tiles that are drawn least often may have no sample in a doubling: they keep the first estimate.
    """
    count = sample + 1
    return count & sample == 0 and (sample == 0 or 4 * count > min(samples, MIN_SAMPLES_TO_STOP))


class EstimateError(Pass):
    """The error of each block, as long as samples double."""

    reads = ("resolved",)
    writes = {"earlier": Target(4, "f4"), "moved": Target(2, "f4", divisor=TILE_SIZE, strips=True)}
    settings = ("quality.error_threshold", "shortcuts")
    depends_on = (Change.SAMPLE,)

    def __init__(self, device: Device):
        super().__init__(device)
        self.counts = np.zeros((0, 0), np.float32)  # of the samples that blocks of the earlier picture had

    @cached_property
    def blocks(self) -> moderngl.VertexArray:
        return self.full_screen_program(tile_size=TILE_SIZE)

    def draw(self, frame: Frame) -> None:
        error, quality = frame.tables["error"], frame.settings.quality
        if is_due(frame.sample, quality.samples):
            if frame.sample:
                error.compare(self.moved(frame), self.counts)
            self.device.gl.copy_framebuffer(frame.targets.into("earlier"), frame.targets.into("resolved"))
            self.counts = error.counts.copy()
        if frame.settings.shortcuts and quality.error_threshold > 0.0 and frame.sample + 1 >= MIN_SAMPLES_TO_STOP:
            error.settle(quality.error_threshold)

    def moved(self, frame: Frame) -> np.ndarray:
        """(H,W) mean squares of the blocks' differences, over the picture's squared mean brightness."""
        pictures = {name: frame.targets[name] for name in ("resolved", "earlier")}
        self.draw_per_tile(frame, frame.targets.into("moved"), self.blocks, **pictures)
        self.device.wait()
        square, bright = np.moveaxis(from_tile_layout(frame.targets.read("moved"), frame.blocks), -1, 0)
        return square / max(float(bright.mean()) ** 2, FLOAT32_TINY)
