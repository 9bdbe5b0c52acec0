# SPDX-License-Identifier: GPL-3.0-or-later
"""Emission through the pixel filter, in tiles with edges of emission: several camera rays a pixel and sample.

Lamps can be many times as bright as all else. So the aliasing of their edges can be most of a picture's error, long
after all else has converged. Camera rays at more positions replace the emission at the sample's position.
"""

import numpy as np

from ....resources import (
    EMISSION_EDGES,
    FILTERED_EMISSION,
    MEAN_LUMINANCE,
    POINT_GRAPHS,
    SUBSAMPLE_EMISSION,
    TILES,
    TLAS,
)
from ....sampling.pixel_grid import filter_margin, subpixel_offsets
from ....scene import Change
from ....spaces import camera_position
from ...accel.bvh import GRID_EXTENT
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl.depth import depth_range
from ...gl.shader_compiler import bind
from ...gl.shader_records import CASTER
from ...materials.point_graphs import NO_POINT_GRAPHS
from ...tiles import neighbourhood_max, tiles_where
from .seen_emission import EMISSION, emission_constants, emission_parts, emission_uniforms

#: Camera rays of a pixel in a sample. In `bench error`, 16 samples of street have an error of .0178 with 4, and .0160
#: with 8. In lanterns, 4 and 8 leave the same error after the same time.
CAMERA_RAYS = 4

#: Contrast of emission, as a fraction of the picture's mean luminance, from which on they are traced. Without them, 16
#: samples leave 0.013 of the contrast as error at edges.
MIN_CONTRAST = 0.5


class FilterEmission(Pass):
    """Filtered radiance W/(sr m²) of surfaces that emit and of lights, where it has edges."""

    inputs = (
        *(*EMISSION, EMISSION_EDGES, TILES, TLAS, POINT_GRAPHS, MEAN_LUMINANCE),
        *(Change.VIEW, Change.SAMPLE),
    )
    outputs = outputs(SUBSAMPLE_EMISSION, FILTERED_EMISSION)

    def needed(self, frame: Frame) -> bool:
        contrast = frame.get(EMISSION_EDGES)
        return contrast is not None and bool(contrast.any())

    def execute(self, frame: Frame) -> None:
        tiles, width = self.tiles(frame), frame.view.filter_width
        margin, surfaces = filter_margin(width), (frame.get(POINT_GRAPHS) or NO_POINT_GRAPHS).camera
        frame.allocate(SUBSAMPLE_EMISSION, (frame.size[0] + 2 * margin, frame.size[1] + 2 * margin))
        constants = emission_constants(frame) | surfaces.constants
        trace = self.tile_program(CASTER, *emission_parts(frame), *surfaces.parts, **constants, border=margin)
        bind(trace, depths=self.depths(frame), transparent_hits=frame.scene.transparent_bounces)
        bind(trace, **frame[TLAS] | emission_uniforms(frame) | surfaces.uniforms)
        add = self.tile_program(suffix="add", margin=margin)
        bind(add, subsample_emission=frame[SUBSAMPLE_EMISSION], filter_radius=width)
        sums = frame.framebuffer(FILTERED_EMISSION)
        sums.clear()
        first = frame.sample * CAMERA_RAYS
        for offset in subpixel_offsets(np.arange(first, first + CAMERA_RAYS), width):
            tiles["subpixel_offset"] = offset
            self.device.overwrite()
            draw_tiles(frame, frame.framebuffer(SUBSAMPLE_EMISSION), trace, tiles, margin, border=margin)
            self.device.add()
            draw_tiles(frame, sums, add, tiles)

    @staticmethod
    def tiles(frame: Frame) -> np.ndarray:
        """Rows of TILE: tiles with edges, whose pixels this sample's tiles are filtered to."""
        drawn = np.zeros(frame.tiles[::-1], bool)
        threshold = MIN_CONTRAST * frame[MEAN_LUMINANCE] if frame.sample > 0 else 0.0
        column, row = frame[TILES]["tile"].astype(int).T
        drawn[row, column] = True
        return tiles_where(neighbourhood_max(drawn) & (frame[EMISSION_EDGES] > threshold))

    @staticmethod
    def depths(frame: Frame) -> tuple[float, float]:
        """Depths at which camera rays start and end: at the near plane, and at the far plane or beyond the scene."""
        near, far = depth_range(frame.view.clip_from_view)
        to_centre = camera_position(frame.view.view_from_world) - frame.anchor - frame[TLAS]["tlas_centre"]
        farthest = np.linalg.norm(np.abs(to_centre) + GRID_EXTENT / np.array(frame[TLAS]["tlas_scale"]))
        return near, max(min(far, float(farthest)), near)
