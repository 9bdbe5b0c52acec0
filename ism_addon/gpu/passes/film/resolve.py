# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture of all samples so far: the mean of what was predicted, and of the corrections what stands out of noise.

A correction is shrinkage by the part that is left when the noise of its neighbourhood is taken from their mean square
(James & Stein 1961): nothing of one ray a pixel, all of it in the end, so nothing of the prediction's error remains.
"""

from functools import cached_property

import moderngl
import numpy as np

from ....scene import Change, Lights
from ...frame import TILE_SIZE, Frame, Pass
from ...gl.render_targets import Target
from ...gl.shader_compiler import bind

#: Stratified samples have less variance than independent ones, by this power of the number of rays. Chosen by the error
#: of the scenes objects, lamps, atrium and thin of `bench error` at 4 to 16 samples.
STRATIFICATION_EXPONENT = 0.4

#: How little neighbours count whose predicted luminances, averaged over the samples, differ; as measured. Where
#: surfaces meet, that tells more than the newest sample's positions and normals do.
SIMILARITY_SHARPNESS = 20.0


class Resolve(Pass):
    """The sums as one picture."""

    reads = ("sum", "sum_correction", "weights", "sum_headroom", "counts")
    writes = {"near": Target(4, "f4"), "stand_out": Target(4, "f4"), "resolved": Target(4, "f4")}
    depends_on = (Change.SAMPLE,)

    @cached_property
    def near(self) -> moderngl.VertexArray:
        return self.full_screen_program(
            part="neighbours",
            tile_size=TILE_SIZE,
            stratification_exponent=STRATIFICATION_EXPONENT,
            similarity_sharpness=SIMILARITY_SHARPNESS,
        )

    @cached_property
    def predicted(self) -> moderngl.VertexArray:
        return self.full_screen_program(tile_size=TILE_SIZE, corrected=0)

    @cached_property
    def corrected(self) -> moderngl.VertexArray:
        return self.full_screen_program(tile_size=TILE_SIZE, corrected=1)

    def draw(self, frame: Frame) -> None:
        self.device.gl.enable_only(moderngl.NOTHING)
        if frame.sample > 0:  # the first one has no corrections
            self.neighbour_statistics(frame)
        pixels = self.corrected if frame.sample > 0 else self.predicted
        bind(
            pixels.program,
            sum=frame.targets["sum"],
            sum_correction=frame.targets["sum_correction"],
            weights=frame.targets["weights"],
            sum_headroom=frame.targets["sum_headroom"],
            counts=frame.tables["counts"],
            near=frame.targets["near"],
            least=min_light(frame.scene.lights),
            stand_out=frame.targets["stand_out"],
        )
        self.draw_pixels(frame, frame.targets.into("resolved"), pixels)

    def neighbour_statistics(self, frame: Frame) -> None:
        """What the neighbours' corrections are, and how they and the differences from them stand to their noise."""
        bind(
            self.near.program,
            sum=frame.targets["sum"],
            sum_correction=frame.targets["sum_correction"],
            weights=frame.targets["weights"],
            counts=frame.tables["counts"],
        )
        self.draw_pixels(frame, frame.targets.into("near", "stand_out"), self.near)


def min_light(lights: Lights) -> float:
    """Nothing, unless lights are negative."""
    return -float(np.finfo(np.float32).max) if (lights.radiance < 0.0).any() else 0.0
