# SPDX-License-Identifier: GPL-3.0-or-later
"""Every pseudorandom decision of the method, and the sequence that it uses.

As in pbrt, no two decisions share a dimension, because they would be correlated: a tile that takes part in every other
sample, for example, would use only half of an occlusion pattern. Numbers depend only on their indices, so samples and
tiles can be drawn independently and in any order.
"""

from collections.abc import Iterable
from enum import Enum
from functools import cache

import numpy as np
import numpy.typing as npt

from .increments import continued_fraction, powers_of_root


class Dimension(Enum):
    """A decision: for each of its indices, the increments (d,) of an additive sequence in [0,1)^d.

    Indices: `sample`, `light`, `tile` (row by row), `pixel`, `probe` and `culling_tile` (in the order of pixel_index
    in shadow_ray.glsl), `ray` of a pixel, `round` of subpixel offsets, and others that are named at their decision.
    """

    # The subpixel offset, if samples do not share a grid.
    PIXEL = {"sample": powers_of_root(1, 0, -1)}
    # Where a transparent surface is drawn. The triangle and the fine pixel, of which a `round` has several samples, are
    # hashed: surfaces behind one another must be independent.
    TRANSPARENCY = {"round": continued_fraction(3, 2, 1, 1)}
    # Whether a tile takes part in a sample.
    TILE_TURN = {"sample": continued_fraction(2, 3, 1, 1), "tile": continued_fraction(2, 1, 1)}

    # The point on a light that a tile probes. `probing` 0: to decide which lights are probed at all; n + 1: to estimate
    # their visibility around the tile before sample n.
    CULLING_POINT = {
        "light": powers_of_root(3, -2, -2),
        "culling_tile": (0.309803, 0.890905),
        "probing": powers_of_root(1, -2, -1),
    }
    # The point on a light that one of four pixels probes before the first sample. The increments of
    # `probe`, of tiles and of retests are among the ten most even of 2,500 random pairs: over 3×3 to 8×8 neighbors and
    # half-occluded lights.
    PROBE_POINT = {"light": powers_of_root(1, -1, -1), "probe": (0.577895, 0.236398)}
    # The direction of a ray that looks for openings to the world.
    PORTAL_POINT = {"probe": (0.913037, 0.899906)}
    # Which lights believed occluded are probed again in which tiles, and at which point. RETEST is the better of two
    # candidates: it discovers lights behind a hole sooner, from four positions, see
    # tests/unit/light_selection/test_cull_lights.py.
    RETEST = {"sample": continued_fraction(3)}
    RETEST_POINT = {
        "light": powers_of_root(2, -2, -1),
        "probe": (0.437579, 0.297618),
        "sample": powers_of_root(1, -1, 0),
    }

    # The point on a light that is a shadow ray's target. The increments of `ray` and `pixel` are even together with the
    # subpixel offsets, which determine a ray's weight, over neighbors, and for thousands of rays. They were chosen by a
    # search with half-occluded lights, see tests/unit/direct/test_ray_sampling.py, and by the error of
    # penumbrae, see tests/stress/pictures/test_penumbrae.py. Of 40 orders of powers for `light`, this one
    # keeps the error in each of the benchmark's six scenes of area lights below 1.01 times that of version 0.1.0.
    LIGHT_POINT = {
        "light": powers_of_root(4, -4, -4),
        "pixel": (0.56283799, 0.75252225),
        "ray": (0.72359394, 0.59242966),
        # From the 65th ray of a pixel to a round light on, by a search with half-occluded discs.
        "late_ray": (0.33888137, 0.76432619),
    }
    # A microfacet's normal, and which of the candidates for a ray to a light is kept. Each is the most even of 60
    # random triples, in 16, 64 and 256 points.
    LOBE_POINT = {
        "light": (0.768356, 0.435963, 0.730877),
        "pixel": (0.557747, 0.694352, 0.216158),
        "ray": (0.685772, 0.645687, 0.186495),
    }
    # In which samples a pixel traces a ray to a light. Its `pixel` counts squares of 4×4.
    RAY_TURN = {
        "light": continued_fraction(1, 1, 1, 2),
        "pixel": continued_fraction(2),
        "round": continued_fraction(1, 3),
    }
    # In which samples a tile tests predictions that are not uncertain.
    TEST_TURN = {
        "light": continued_fraction(1, 2),
        "tile": continued_fraction(1, 1, 3),
        "round": continued_fraction(2, 1, 1, 1),
    }
    # In which samples a faint light is drawn in a tile.
    LIGHT_CHOICE = {"light": continued_fraction(3, 1, 1, 1), "tile": continued_fraction(1, 3, 1, 1)}

    # The points of a light at which its profile and its image are averaged. By a search of 300 random pairs, for a
    # striped image on three lights and a narrow profile, in 1 to 256 samples.
    MEAN_POINT = {"sample": (0.761254, 0.792134)}

    # Where in a part of a triangle its emission is evaluated, and in which direction. The most even of random ones.
    EMISSION_POINT = {"point": (0.321252, 0.221982, 0.601598, 0.74147)}

    # Points on a mesh; which points of the cloud a light's maps show; the points for the lights' importance. Another
    # MAP_POINT raised the error of shadow maps by 4 % in the benchmark's scene lamps, another POINT_CHOICE by 2 % in
    # corridor. All lights rank the points in the same order, so that equal lights have equal maps.
    MAP_POINT = {"point": powers_of_root(1, 0, 0, -1)}
    POINT_CHOICE = {"point": continued_fraction(1)}
    IMPORTANCE_POINT = {"point": continued_fraction(1, 1, 3, 1)}
    # Which points of transparent surfaces are left.
    POINT_TRANSPARENCY = {"point": continued_fraction(4, 2, 1, 1)}
    # The positions of virtual lights on a light: the lattice's shift, and its points' second coordinates. These make it
    # as even as the golden ratio would, for 5 to 512 points and 60 random edges.
    VIRTUAL_LIGHT = {"light": powers_of_root(-1, 1, 3), "sample": powers_of_root(2, -3, 0)}
    VIRTUAL_LIGHT_ROW = {"virtual_light": continued_fraction(3, 2, 2)}
    # The rotation of a shadow map about its axis: `map` counts all maps drawn so far.
    MAP_ROTATION = {"map": continued_fraction(1, 2, 2, 1)}

    # Where around a pixel occlusion is tested: radius in the cone's cap, angle, distance; and the sample's increments
    # of angle and distance. Of 30 orders of powers and eight pairs, these are unbiased and have the least error in 8 to
    # 32 samples, for boxes on a floor from two sides: see tests/unit/occlusion/test_ambient_occlusion.py.
    OCCLUSION = {"direction": tuple(powers_of_root(1, 0, 0, -2)[k] for k in (0, 2, 1))}
    OCCLUSION_ROTATION = {"sample": powers_of_root(1, 1, -3)[::-1]}
    # The direction of a slice around a pixel, and where it is searched. With white noise for `pixel`, smooth corners
    # have twice the error in a first sample. These pairs, and those of the next two decisions, are the most even of
    # 4,000 random ones, in 16, 64 and 256 points.
    OCCLUSION_SLICE = {"sample": (0.757856, 0.056807), "pixel": (0.201569, 0.053271)}
    # The direction of a ray of ambient occlusion. `sample` has the least error of sixteen even pairs after 16 and 64
    # samples, in `bench occlusion`.
    OCCLUSION_RAY = {"sample": (0.740072, 0.156613), "pixel": (0.940165, 0.753979)}
    # The direction of a ray of a node Ambient Occlusion.
    NODE_RAY = {"ray": (0.130682, 0.680662), "pixel": (0.904838, 0.852099)}
    # The color of a triangle in the debug view.
    DEBUG_COLOR = {"triangle": powers_of_root(2, 0, -1, -2), "instance": powers_of_root(-1, 2, 0, 1)}


def draw(dimension: Dimension, **indices: npt.ArrayLike) -> np.ndarray:
    """(…,d) float64 in [0,1): a decision's numbers for these indices, which count from 0 and are broadcast together.

    Indices that only shaders add are omitted here. Raises KeyError for an index that the decision does not have.
    """
    increments = increments_of(dimension)
    terms = [(np.asarray(value, np.float64)[..., None] + 1.0) * increments[index] for index, value in indices.items()]
    return np.mod(sum(terms, 0.5), 1.0)


@cache
def increments_of(dimension: Dimension) -> dict[str, np.ndarray]:
    """By index, the increments (d,) float64 of a decision."""
    return {index: np.array(increments, np.float64) for index, increments in dimension.value.items()}


def fixed_points(numbers: np.ndarray) -> np.ndarray:
    """(…,) uint32: numbers (…,) in [0,1) in 32-bit fixed point. Sums wrap around as intended, and keep all digits."""
    return (np.rint(numbers * 2.0**32) % 2.0**32).astype(np.uint32)


def fixed_point(numbers: Iterable[float]) -> tuple[int, ...]:
    """The same for a few numbers, as a uniform."""
    return tuple(fixed_points(np.array([*numbers])).tolist())


def fixed_increments(dimension: Dimension, index: str) -> tuple[int, ...]:
    """(d,) fixed_point: what a shader adds per increment of an index. Raises KeyError like `draw`."""
    return fixed_point(dimension.value[index])


def white_noise(dimension: Dimension, shape: tuple[int, ...]) -> np.ndarray:
    """Independent float32 in [0,1), for a decision whose numbers must not be evenly distributed."""
    return np.random.default_rng(list(dimension.name.encode())).random(shape, np.float32)
