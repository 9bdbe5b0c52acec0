# SPDX-License-Identifier: GPL-3.0-or-later
"""Sums of the samples of a picture, filtered.

A sample is added to all pixels whose Blackman-Harris filter covers it, with the filter's weight. In neighbouring tiles
the weight is multiplied by the ratio of the tiles' probabilities: otherwise pixels near the border of two tiles would
look like the tile that is drawn more often. In converged tiles the weight is 0.

A wide filter is applied along rows, then along columns. Samples are then treated as if they lay at the pixels' centres.
That widens the filter by a pixel, so its radius is reduced accordingly.
"""

import math
from dataclasses import replace
from typing import Any

from ....resource_types import Lifetime, Target
from ....resources import (
    DEBUG_IMAGE,
    FILTERED_EMISSION,
    SAMPLE_COLOR,
    SAMPLE_EMISSION,
    SAMPLE_HEADROOM,
    SAMPLE_RESIDUAL,
    SUM_COLOR,
    SUM_HEADROOM,
    SUM_RESIDUAL,
    SUM_WEIGHTS,
    TILE_PROBABILITIES,
    TILE_SIZE,
    TILES,
)
from ....sampling.pixel_grid import filter_margin, has_wide_filter
from ....scene import Change
from ...drawing import draw_pixels, draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl.draw_limit import TEXELS_PER_RAY
from ...gl.shader_compiler import bind

#: Samples that are fetched and weighted in the time of one blend operation.
SAMPLES_PER_BLEND = 4

#: A pixel's variance, relative to that of a Blackman-Harris filter of radius 1 px: 1 / 12 / 0.076736.
RELATIVE_VARIANCE = 1.08598

SUMS = SUM_COLOR, SUM_RESIDUAL, SUM_WEIGHTS, SUM_HEADROOM


def _wide_filter_targets(prefix: str, about: str) -> tuple[Target, ...]:
    return tuple(
        replace(target, name=f"{prefix}_{target.name}", about=about, lifetime=Lifetime.SAMPLE, divisor=0, neutral=None)
        for target in SUMS
    )


#: For wide filters: what a sample adds to its own pixels, and the same filtered in rows.
SAMPLES = _wide_filter_targets("sample", "What a sample adds to its own pixels")
ROWS = _wide_filter_targets("row", "The same, filtered in rows")


def rays_for(samples: int) -> float:
    """Time to add this many samples to a pixel's sums, in units of the time of a ray."""
    return len(SUMS) * (samples + SAMPLES_PER_BLEND) / TEXELS_PER_RAY


class Accumulate(Pass):
    """The sums of all samples so far: of predictions, residuals, headroom and weights."""

    inputs = (
        *(TILES, TILE_PROBABILITIES, SAMPLE_COLOR, SAMPLE_RESIDUAL, SAMPLE_HEADROOM, DEBUG_IMAGE),
        *(SAMPLE_EMISSION, FILTERED_EMISSION, Change.SAMPLE, "debug_view"),
    )
    outputs = outputs(*SUMS, *SAMPLES, *ROWS)

    def execute(self, frame: Frame) -> None:
        is_first, is_render = frame.sample == 0, frame.settings.debug_view == SAMPLE_COLOR.name
        margin = filter_margin(frame.view.filter_width)
        begin_sums = self.device.overwrite if is_first else self.device.add
        has_residual = int(is_render and not is_first)  # the first sample has only predictions
        emission = int(is_render and not frame.is_neutral(SAMPLE_EMISSION))
        constants: dict[str, Any] = {"has_residual": has_residual, "emission": emission}
        samples: dict[str, Any] = {
            "sample_color": frame[SAMPLE_COLOR if is_render else DEBUG_IMAGE],
            "sample_residual": frame[SAMPLE_RESIDUAL],
            "sample_headroom": frame[SAMPLE_HEADROOM],
            "tile_probabilities": frame[TILE_PROBABILITIES],
            **({"sample_emission": frame[SAMPLE_EMISSION]} if emission else {}),
        }
        if not has_wide_filter(frame.view.filter_width):
            filtered = int(emission and not frame.is_neutral(FILTERED_EMISSION))
            samples |= {"filtered_emission": frame[FILTERED_EMISSION]} if filtered else {}
            begin_sums()
            program = self.tile_program(margin=margin, first_sample=int(is_first), filtered=filtered, **constants)
            bind(program, **samples, filter_radius=frame.view.filter_width)
            rays = rays_for((2 * margin + 1) ** 2)
            draw_tiles(frame, frame.framebuffer(*SUMS), program, margin=0 if is_first else margin, rays=rays)
            return
        self.device.overwrite()
        for target in (*SAMPLES, *ROWS):
            frame.allocate(target, frame.size)
        sample_framebuffer = frame.framebuffer(*SAMPLES)
        sample_framebuffer.clear()
        program = self.tile_program(suffix="taken", **constants)
        bind(program, **samples)
        draw_tiles(frame, sample_framebuffer, program, rays=rays_for(1))
        self.draw_lines(frame, SAMPLES, ROWS)
        begin_sums()
        self.draw_lines(frame, ROWS, SUMS)

    def draw_lines(self, frame: Frame, source: tuple[Target, ...], destination: tuple[Target, ...]) -> None:
        """Filter along rows; along columns if the destination is SUMS."""
        radius = frame.view.filter_width
        lines = self.full_screen_program(suffix="lines", tile_size=TILE_SIZE, columns=int(destination is SUMS))
        samplers = "lines_color", "lines_residual", "lines_weights", "lines_headroom"
        bind(
            lines.program,
            **{sampler: frame[target] for sampler, target in zip(samplers, source, strict=True)},
            tile_probabilities=frame[TILE_PROBABILITIES],
            filter_radius=math.sqrt(radius * radius - RELATIVE_VARIANCE),
            margin=filter_margin(radius),
        )
        draw_pixels(frame, frame.framebuffer(*destination), lines, rays_for(2 * filter_margin(radius) + 1))
