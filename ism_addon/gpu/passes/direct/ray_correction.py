# SPDX-License-Identifier: GPL-3.0-or-later
"""Which rays correct a prediction."""

from typing import Any

import numpy as np

from ....resources import MEAN_LUMINANCE
from ....sampling.dimensions import Dimension, draw, fixed_increments, fixed_point
from ...frame import Frame
from ...gl.shader_records import CASTER, LIGHT, MEMBERSHIP

#: A pixel has a ray for sure if that may change it by this part of the picture's mean luminance.
RAY_THRESHOLD = 0.1

#: Doubt in a prediction that all rays of a neighbourhood agree on.
MIN_DOUBT = 0.03

#: What their shaders fetch.
RECORDS = LIGHT, CASTER, MEMBERSHIP


def shader_constants(
    variant: dict[str, int], rays: int, subpixel_offsets: int, min_probability: float
) -> dict[str, Any]:
    """Constants of the shader for a variant of lights: `rays` is 0 or 1; a grid has so many subpixel offsets."""
    return {
        "trace": rays,
        "subpixel_offsets": subpixel_offsets,
        "min_doubt": MIN_DOUBT,
        "min_probability": min_probability,
        **variant,
    }


def ray_sequence() -> dict[str, tuple[int, ...]]:
    """Uniforms: which ray of a pixel goes where on its light, and in which sample."""
    turns = (fixed_increments(Dimension.RAY_TURN, index) for index in ("pixel", "round"))
    return {
        "pixel_steps": fixed_increments(Dimension.LIGHT_POINT, "pixel"),
        "ray_steps": fixed_increments(Dimension.LIGHT_POINT, "ray"),
        "turn_steps": tuple(step for steps in turns for step in steps),
    }


def light_shift(light: int) -> tuple[int, ...]:
    """(3,) of a light: where on it the first pixel's first ray goes, and when."""
    return fixed_point([*draw(Dimension.LIGHT_POINT, light=light), *draw(Dimension.RAY_TURN, light=light)])


def light_steps() -> tuple[int, ...]:
    """(3,) the same from light to light."""
    return fixed_increments(Dimension.LIGHT_POINT, "light") + fixed_increments(Dimension.RAY_TURN, "light")


def ray_threshold(frame: Frame) -> float:
    """The change of a pixel's luminance that a ray is traced for in any case."""
    return RAY_THRESHOLD * frame[MEAN_LUMINANCE] if frame.settings.shortcuts else float(np.finfo(np.float32).tiny)
