# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers in [0,1): low-discrepancy, and the same for the same input."""

from collections.abc import Iterable
from enum import Enum

import numpy as np


def rd_sequence(first: int, count: int, dimensions: int) -> np.ndarray:
    """(count, dimensions) float64 in [0,1): members first … of the R_d sequence.

    Generalised golden ratios (Roberts 2018): every run of neighbours is evenly spread, so any prefix and
    any slice is itself a good set.
    """
    return members(rd_increments(dimensions), first, count)


def rd_increments(dimensions: int) -> tuple[float, ...]:
    """The increments of R_d."""
    root = 1.5
    for _ in range(64):
        root = (1.0 + root) ** (1.0 / (dimensions + 1))
    return tuple(root ** -np.arange(1.0, dimensions + 1))


def members(steps: tuple[float, ...], first: int, count: int) -> np.ndarray:
    """(count, d) float64 in [0,1): members first … of the additive sequence with increments `steps` (d,)."""
    return np.modf(0.5 + np.outer(np.arange(first + 1, first + 1 + count, dtype=np.float64), steps))[0]


class Dimension(Enum):
    """What is decided by random numbers that change from sample to sample: each by increments of its own.

    Two decisions by the same numbers would follow each other: a tile that takes part in every other sample, say, would
    only ever see half of an occlusion pattern. In one dimension they are quadratic irrationals with small partial
    quotients, which are as even as the golden ratio up to a factor of two. Of rd_increments(4), three times the first
    is almost the second of rd_increments(2).
    """

    TILE_TURN = rd_increments(1)  # whether a tile takes part
    RETEST_TURN = ((13**0.5 - 3.0) / 2.0,)  # which hidden lights are looked for again, and where
    OCCLUSION_TURN = (3**0.5 - 1.0,)  # the pattern of ambient occlusion
    PIXEL = rd_increments(2)  # the place in the pixel, where samples do not share a grid
    VIRTUAL_LIGHT = rd_increments(3)[:2]  # the shift of a light's virtual point lights
    RETEST_POINT = rd_increments(4)[2:]  # the point on the light that is looked for


def sequence(dimension: Dimension, first: int, count: int) -> np.ndarray:
    """(count, d) float64 in [0,1): members first … of a decision's own sequence."""
    return members(dimension.value, first, count)


def fixed_point(numbers: Iterable[float]) -> tuple[int, ...]:
    """Of numbers in [0,1), 32-bit fixed point: sums wrap as they should, and never lose digits."""
    return tuple(round(number * 2**32) % 2**32 for number in numbers)


#: Steps of a ray's place on its light, from a pixel's ray to its next one, and from pixel to pixel in the order of
#: pixel_member in shadow_ray.glsl. Close to those of the additive sequence, but even together with the places in the
#: pixel, which say how much a ray counts, and over neighbours, and for thousands of rays: found by search among
#: half-seen lights, see tests/unit/direct/test_ray_sampling.py, and by the error of penumbrae, see
#: tests/stress/pictures/test_closed_forms.py.
RAY_INCREMENTS = (0.72359394, 0.59242966)
PIXEL_INCREMENTS = (0.56283799, 0.75252225)

#: Steps of when it is a pixel's turn to have a ray: from pixel to pixel, and from round to round of places in a pixel.
TURN_INCREMENTS = (2**0.5 - 1.0, (21**0.5 - 3.0) / 2.0)

#: And from light to light: of the place, of a pixel's turn, and of a tile's.
LIGHT_INCREMENTS = rd_increments(4)
