# SPDX-License-Identifier: GPL-3.0-or-later
"""Which pixels trace rays that correct a prediction, and to which points of a light."""

import math
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np

from ....resources import MEAN_LUMINANCE
from ....sampling.dimensions import Dimension, draw, fixed_increments, fixed_point
from ...frame import Frame
from ...gl.shader_records import CASTER, LIGHT_RECORDS, MEMBERSHIP
from ...tiles import relative_cost

#: In large pictures, a pixel traces a ray in each sample if the ray can change the pixel by this fraction of the
#: picture's mean luminance; in dark tiles by less, see DARKEST in surfaces/select_tiles.py. If it can change it by
#: more, as many more are traced, up to the MAX_RAYS of the light's type. In small pictures a ray is a smaller part of
#: a sample's time, so that more rays pay.
RAY_THRESHOLD = 0.3

#: Uncertainty of a prediction if all rays of a neighbourhood agree. For both see `dev.py bench constants` in
#: docs/benchmarks.md.
MIN_DOUBT = 0.03

#: Records that the shaders fetch.
RECORDS = *LIGHT_RECORDS, CASTER, MEMBERSHIP


def shader_constants(
    variant: dict[str, int], rays: int, correct: int, subpixel_offsets: int, min_probability: float
) -> dict[str, Any]:
    """Constants of the shader for a variant of lights.

    `rays`: 1 if it traces rays, or 0; `correct`: 1 if it corrects glossy reflections even without rays, or 0.
    """
    return {
        "trace": rays,
        "correct": correct,
        "subpixel_offsets": subpixel_offsets,
        "min_doubt": MIN_DOUBT,
        "min_probability": min_probability,
        **variant,
    }


@cache
def ray_sequence(is_round: bool = False) -> Mapping[str, tuple[int, ...]]:
    """Uniforms: increments of the sequences of points on a light, and of phases of the rays' schedule.

    `is_round`: whether the points lie on a disc.
    """
    increments = (fixed_increments(Dimension.RAY_TURN, index) for index in ("pixel", "round"))
    return {
        "pixel_steps": fixed_increments(Dimension.LIGHT_POINT, "pixel"),
        "ray_steps": fixed_increments(Dimension.LIGHT_POINT, "ray"),
        "late_ray_steps": fixed_increments(Dimension.LIGHT_POINT, "late_ray" if is_round else "ray"),
        "schedule_steps": tuple(step for steps in increments for step in steps),
    }


@cache
def lobe_sequence() -> Mapping[str, tuple[int, ...]]:
    """Uniforms: increments of the sequence of candidates for glossy lobes."""
    return {f"lobe_{index}_steps": fixed_increments(Dimension.LOBE_POINT, index) for index in ("pixel", "ray", "light")}


@cache
def lobe_shift(light: int) -> tuple[int, ...]:
    """(3,) start values of this sequence for a light, in 32-bit fixed point."""
    return fixed_point(draw(Dimension.LOBE_POINT, light=light))


@cache
def light_shift(light: int) -> tuple[int, ...]:
    """(3,) start values of these sequences for a light, in 32-bit fixed point."""
    return fixed_point([*draw(Dimension.LIGHT_POINT, light=light), *draw(Dimension.RAY_TURN, light=light)])


@cache
def light_steps() -> tuple[int, ...]:
    """(3,) increments of light_shift from each light to the next."""
    return fixed_increments(Dimension.LIGHT_POINT, "light") + fixed_increments(Dimension.RAY_TURN, "light")


def ray_threshold(frame: Frame) -> float:
    """Change of a pixel's luminance from which on a ray is traced in each sample, where it is the picture's mean."""
    if not frame.settings.shortcuts:
        return float(np.finfo(np.float32).tiny)
    # The least product of squared error and time is with a number of rays as the root of the time of all else.
    return RAY_THRESHOLD * frame[MEAN_LUMINANCE] / math.sqrt(relative_cost(math.prod(frame.tiles)))
