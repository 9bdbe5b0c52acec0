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
from typing import Any, ClassVar

import moderngl

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
from ....resources.world import (
    SAMPLE_OCCLUSION,
    SAMPLE_OCCLUSION_HEADROOM,
    SAMPLE_OCCLUSION_RESIDUAL,
    SUM_OCCLUSION,
    SUM_OCCLUSION_HEADROOM,
    SUM_OCCLUSION_RESIDUAL,
    SUM_OCCLUSION_WEIGHTS,
)
from ....sampling.pixel_grid import filter_margin, has_wide_filter
from ....scene import Change
from ...drawing import draw_pixels, draw_tiles
from ...frame import Frame, Input, Pass, outputs
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

    SUMS: ClassVar[tuple[Target, ...]] = SUMS
    inputs: ClassVar[tuple[Input, ...]] = (
        *(TILES, TILE_PROBABILITIES, SAMPLE_COLOR, SAMPLE_RESIDUAL, SAMPLE_HEADROOM, DEBUG_IMAGE),
        *(SAMPLE_EMISSION, FILTERED_EMISSION, Change.SAMPLE, "debug_view"),
    )
    outputs = outputs(*SUMS, *SAMPLES, *ROWS)

    def samplers(self, frame: Frame) -> dict[str, moderngl.Texture]:
        """What is summed: the render, or the debug view."""
        if frame.settings.debug_view != SAMPLE_COLOR.name:
            return {"sample_color": frame[DEBUG_IMAGE], "sample_headroom": frame[SAMPLE_HEADROOM]}
        emission = {"sample_emission": SAMPLE_EMISSION, "filtered_emission": FILTERED_EMISSION}
        return {
            "sample_color": frame[SAMPLE_COLOR],
            "sample_residual": frame[SAMPLE_RESIDUAL],
            "sample_headroom": frame[SAMPLE_HEADROOM],
            **{name: frame[target] for name, target in emission.items() if not frame.is_neutral(target)},
        }

    def execute(self, frame: Frame) -> None:
        is_first, margin = frame.sample == 0, filter_margin(frame.view.filter_width)
        is_wide = has_wide_filter(frame.view.filter_width)
        begin_sums = self.device.overwrite if is_first else self.device.add
        samples: dict[str, Any] = self.samplers(frame) | {"tile_probabilities": frame[TILE_PROBABILITIES]}
        filtered = samples.pop("filtered_emission", None) if is_wide else samples.get("filtered_emission")
        constants: dict[str, Any] = {
            "has_residual": int("sample_residual" in samples and frame.corrects),
            "emission": int("sample_emission" in samples),
        }
        if not is_wide:
            begin_sums()
            constants |= {"margin": margin, "first_sample": int(is_first), "filtered": int(filtered is not None)}
            program = self.tile_program(**constants)
            bind(program, **samples, filter_radius=frame.view.filter_width)
            rays = rays_for((2 * margin + 1) ** 2)
            draw_tiles(frame, frame.framebuffer(*self.SUMS), program, margin=0 if is_first else margin, rays=rays)
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
        self.draw_lines(frame, ROWS, self.SUMS)

    def draw_lines(self, frame: Frame, source: tuple[Target, ...], destination: tuple[Target, ...]) -> None:
        """Filter along rows; from ROWS, along columns."""
        radius = frame.view.filter_width
        lines = self.full_screen_program(suffix="lines", tile_size=TILE_SIZE, columns=int(source is ROWS))
        samplers = "lines_color", "lines_residual", "lines_weights", "lines_headroom"
        bind(
            lines.program,
            **{sampler: frame[target] for sampler, target in zip(samplers, source, strict=True)},
            tile_probabilities=frame[TILE_PROBABILITIES],
            filter_radius=math.sqrt(radius * radius - RELATIVE_VARIANCE),
            margin=filter_margin(radius),
        )
        draw_pixels(frame, frame.framebuffer(*destination), lines, rays_for(2 * filter_margin(radius) + 1))


class AccumulateOcclusion(Accumulate):
    """The same sums of the render pass AO."""

    SUMS = SUM_OCCLUSION, SUM_OCCLUSION_RESIDUAL, SUM_OCCLUSION_WEIGHTS, SUM_OCCLUSION_HEADROOM
    inputs = (
        *(TILES, TILE_PROBABILITIES, SAMPLE_OCCLUSION, SAMPLE_OCCLUSION_RESIDUAL, SAMPLE_OCCLUSION_HEADROOM),
        Change.SAMPLE,
    )
    outputs = outputs(*SUMS, *SAMPLES, *ROWS)

    def samplers(self, frame: Frame) -> dict[str, moderngl.Texture]:
        return {
            "sample_color": frame[SAMPLE_OCCLUSION],
            "sample_residual": frame[SAMPLE_OCCLUSION_RESIDUAL],
            "sample_headroom": frame[SAMPLE_OCCLUSION_HEADROOM],
        }
