# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles with edges of emission. Lamps can be many times as bright as all else: so is the aliasing of their edges."""

import numpy as np

from ....resources import EMISSION_CONTRAST, EMISSION_EDGES, SAMPLE_EMISSION, TILE_SIZE
from ....sampling.pixel_grid import filter_margin, has_wide_filter
from ....scene import Change
from ...drawing import draw_per_tile
from ...frame import Frame, Pass, Schedule, outputs
from ...tiles import from_strips


class FindEmissionEdges(Pass):
    """The contrast of emission among the samples that are filtered to a tile's pixels."""

    schedule = Schedule.DOUBLING  # further samples show additional surfaces
    inputs = SAMPLE_EMISSION, Change.VIEW, Change.INSTANCES, Change.SAMPLE
    outputs = outputs(EMISSION_CONTRAST, EMISSION_EDGES)

    def needed(self, frame: Frame) -> bool:
        """Whether the camera sees emission, and all that it sees is in the BVH, which camera rays need."""
        instances = frame.scene.instances
        in_bvh = frame.traces_shadows and bool((instances.casts_shadow | ~instances.visible).all())
        return in_bvh and not frame.is_neutral(SAMPLE_EMISSION) and not has_wide_filter(frame.view.filter_width)

    def execute(self, frame: Frame) -> None:
        self.device.overwrite()
        shader = self.full_screen_program(tile_size=TILE_SIZE, margin=filter_margin(frame.view.filter_width))
        draw_per_tile(frame, frame.framebuffer(EMISSION_CONTRAST), shader, sample_emission=frame[SAMPLE_EMISSION])
        self.device.wait()
        contrast = from_strips(frame.read(EMISSION_CONTRAST), frame.tiles)[..., 0]
        frame[EMISSION_EDGES] = contrast if frame.sample == 0 else np.maximum(frame[EMISSION_EDGES], contrast)
