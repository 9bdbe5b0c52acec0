# SPDX-License-Identifier: GPL-3.0-or-later
"""Every pseudorandom decision of the method, and the numbers that it takes.

As in pbrt, no two decisions share a dimension: they would follow each other. A tile that takes part in every other
sample, say, would only ever see half of an occlusion pattern. Numbers depend on their indices alone, so any sample of
any tile can be drawn by itself, in any order.
"""

from collections.abc import Iterable
from enum import Enum

import numpy as np
import numpy.typing as npt

from .increments import continued_fraction, powers_of_root


class Dimension(Enum):
    """A decision: by each index that its numbers have, the increments (d,) of an additive sequence in [0,1)^d.

    Indices: `sample`, `light`, `tile` (row by row), `pixel`, `probe` and `culling_tile` (in the order of pixel_member
    in shadow_ray.glsl), `ray` of a pixel, `round` of subpixel offsets, and others that are named at their decision.
    """

    # The subpixel offset, where samples do not share a grid.
    PIXEL = {"sample": powers_of_root(1, 0, -1)}
    # Whether a tile takes part in a sample.
    TILE_TURN = {"sample": continued_fraction(2, 3, 1, 1), "tile": continued_fraction(2, 1, 1)}

    # The point on a light that a tile probes: `probing` 0 tells which lights are looked for at all, n + 1 how much of
    # them arrives about the tile, before sample n.
    CULLING_POINT = {
        "light": powers_of_root(3, -2, -2),
        "culling_tile": (0.309803, 0.890905),
        "probing": powers_of_root(1, -2, -1),
    }
    # The point on a light that one of four pixels probes before the first sample. From probe to probe, and of tiles and
    # retests, pairs are among the ten evenest of 2,500 random ones: over 3×3 to 8×8 neighbors, half-occluded lights.
    PROBE_POINT = {"light": powers_of_root(1, -1, -1), "probe": (0.577895, 0.236398)}
    # Which lights believed occluded are probed again in which tiles, and at which point. RETEST is the better of two
    # in how soon lights behind a hole are found, from four places: see tests/unit/light_selection/test_cull_lights.py.
    RETEST = {"sample": continued_fraction(3)}
    RETEST_POINT = {
        "light": powers_of_root(2, -2, -1),
        "probe": (0.437579, 0.297618),
        "sample": powers_of_root(1, -1, 0),
    }

    # The point on a light that a shadow ray goes to. From ray to ray and from pixel to pixel the increments are even
    # together with the subpixel offsets, which say how much a ray counts, over neighbors, and for thousands of rays:
    # found by search among half-occluded lights, see tests/unit/direct/test_ray_sampling.py, and by the error of
    # penumbrae, see tests/stress/pictures/test_closed_forms.py.
    LIGHT_POINT = {
        "light": powers_of_root(1, -3, 1),
        "pixel": (0.56283799, 0.75252225),
        "ray": (0.72359394, 0.59242966),
    }
    # In which samples a pixel traces a ray to a light. Its `pixel` counts squares of 4×4.
    RAY_TURN = {
        "light": continued_fraction(1, 1, 1, 2),
        "pixel": continued_fraction(2),
        "round": continued_fraction(1, 3),
    }
    # In which samples a tile tests a prediction that nothing speaks against.
    TEST_TURN = {
        "light": continued_fraction(1, 2),
        "tile": continued_fraction(1, 1, 3),
        "round": continued_fraction(2, 1, 1, 1),
    }
    # In which samples a faint light is drawn in a tile.
    LIGHT_CHOICE = {"light": continued_fraction(3, 1, 1, 1), "tile": continued_fraction(1, 3, 1, 1)}

    # Points on a mesh; which of the cloud's a light's maps show; those that lights are weighed by. Another MAP_POINT
    # raised the error of shadow maps by 4 % in the benchmark's scene lamps, another POINT_CHOICE by 2 % in corridor.
    # All lights rank the points alike, so that equal lights have equal maps.
    MAP_POINT = {"point": powers_of_root(1, 0, 0, -1)}
    POINT_CHOICE = {"point": continued_fraction(1)}
    IMPORTANCE_POINT = {"point": continued_fraction(1, 1, 3, 1)}
    # Where on a light its virtual lights are: the lattice's shift, and its points' second coordinates. By these it is
    # as even as by the golden ratio, for 5 to 512 points before 60 random edges.
    VIRTUAL_LIGHT = {"light": powers_of_root(-1, 1, 3), "sample": powers_of_root(2, -3, 0)}
    VIRTUAL_LIGHT_ROW = {"virtual_light": continued_fraction(3, 2, 2)}
    # How a shadow map is turned about its axis: `map` counts all that were drawn.
    MAP_ROTATION = {"map": continued_fraction(1, 2, 2, 1)}

    # Where around a pixel occlusion is looked for: radius in the cone's cap, angle, distance; and what a sample adds to
    # angle and distance. Of 30 orders of powers and eight pairs, those are right on average and have the least error in
    # 8 to 32 samples, for boxes on a floor from two sides: see tests/unit/environment/test_ambient_occlusion.py.
    OCCLUSION = {"direction": tuple(powers_of_root(1, 0, 0, -2)[k] for k in (0, 2, 1))}
    OCCLUSION_ROTATION = {"sample": powers_of_root(1, 1, -3)[::-1]}
    # The color that stands for a triangle.
    DEBUG_COLOR = {"triangle": powers_of_root(2, 0, -1, -2), "instance": powers_of_root(-1, 2, 0, 1)}


def draw(dimension: Dimension, **indices: npt.ArrayLike) -> np.ndarray:
    """(…,d) float64 in [0,1): a decision's numbers at these indices, which are counted from 0 and broadcast together.

    What shaders add for an index is left out here. Raises KeyError for an index that the decision does not have.
    """
    steps = dimension.value
    terms = (np.multiply.outer(np.asarray(at, np.float64) + 1.0, steps[index]) for index, at in indices.items())
    return np.mod(sum(terms, 0.5), 1.0)


def fixed_point(numbers: Iterable[float]) -> tuple[int, ...]:
    """Of numbers in [0,1), 32-bit fixed point: sums wrap as they should, and never lose digits."""
    return tuple(round(number * 2**32) % 2**32 for number in numbers)


def fixed_increments(dimension: Dimension, index: str) -> tuple[int, ...]:
    """(d,) what a shader adds for each step of an index, as `fixed_point`. Raises KeyError as `draw`."""
    return fixed_point(dimension.value[index])


def white_noise(dimension: Dimension, shape: tuple[int, ...]) -> np.ndarray:
    """Independent float32 in [0,1), for a decision that must not be even."""
    return np.random.default_rng(list(dimension.name.encode())).random(shape, np.float32)
