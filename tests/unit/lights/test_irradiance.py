# SPDX-License-Identifier: GPL-3.0-or-later
"""The shader's unshadowed irradiance against float64, from close to the light to a million light sizes away."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ism_addon.radiometry import MIN_SPREAD
from ism_addon.scene import Lights, LightShape
from tests.support.reference_irradiance import irradiance, spread_integral
from tests.support.small_scenes import AREA_SHAPES, light

from .conftest import RECEIVERS


def unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def single(array: np.ndarray) -> np.ndarray:
    """The values rounded to single precision."""
    return np.asarray(array, np.float32).astype(np.float64)


def some_light(random: np.random.Generator, shape: LightShape, aspect: float, offset: float, spread: float) -> Lights:
    """A light of random size and direction, sheared, mirrored or not, `offset` m away from the origin."""
    rotation, _ = np.linalg.qr(random.normal(size=(3, 3)))
    size = 10.0 ** random.uniform(-2.0, 1.0)
    u, v = size * rotation[0], size * aspect * (random.choice([-1.0, 1.0]) * rotation[1])
    lights = light(
        shape, single(offset * unit(random.normal(size=3))), single(u), single(v + 0.3 * aspect * u), spread=spread
    )
    return replace(lights, normal=np.sign(random.normal()) * lights.normal)


def some_points(random: np.random.Generator, lights: Lights, distance: float) -> np.ndarray:
    """(N,3) receivers on the emitting side: close ones in front of the light or its rim, the others anywhere."""
    u, v, normal = lights.axis_u[0], lights.axis_v[0], lights.normal[0]
    if distance < 0.3:
        angle = random.uniform(0.0, 2.0 * np.pi, RECEIVERS)
        at = np.stack([np.cos(angle), np.sin(angle)], 1) * random.choice(
            [0.2, 0.5, 0.5 - distance, 0.7], (RECEIVERS, 1)
        )
        offsets = at @ np.stack([u, v]) + distance * np.linalg.norm(v) * normal
    else:
        offsets = unit(random.normal(size=(RECEIVERS, 3)))
        offsets *= np.sign(offsets @ normal)[:, None] * distance * np.linalg.norm(u)
    return single(lights.position[0] + offsets)


def conditioned(lights: Lights, points: np.ndarray, normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(N,) true irradiance, and by how much it changes when a receiver moves by a few float32 roundings."""
    truth = np.array([irradiance(p, n, lights) for p, n in zip(points, normals, strict=True)])
    to_light = lights.position[0] - points
    step = 2e-7 * (np.linalg.norm(to_light, axis=1) + np.linalg.norm(lights.axis_u[0]))
    moved = [
        [irradiance(p + s * d, n, lights) for p, n, s in zip(points, normals, step, strict=True)]
        for d in np.concatenate([np.eye(3), -np.eye(3)])
    ]
    return truth, np.abs(np.array(moved) - truth).max(0)


def rounding(lights: Lights, points: np.ndarray) -> np.ndarray:
    """(N,) error of a few float32 roundings of the term of one edge."""
    return 1e-6 * np.minimum(
        1.0, np.linalg.norm(lights.axis_u[0]) / np.linalg.norm(lights.position[0] - points, axis=1)
    )


seeds = st.integers(0, 2**32 - 1)


BOTH_SHAPES = pytest.mark.parametrize("shape", AREA_SHAPES)
ASPECTS, OFFSETS = st.sampled_from([1.0, 0.5, 0.1]), st.sampled_from([0.0, 1e3])


@BOTH_SHAPES
@settings(max_examples=40, deadline=None, derandomize=True)
@given(seed=seeds, exponent=st.floats(-6.0, 6.0), aspect=ASPECTS, offset=OFFSETS)
def test_a_receiver_that_faces_the_light_is_exact(shader, shape, seed, exponent, aspect, offset):
    """Within 1e-5, a few roundings of what an edge can send, and a few of the receiver's place."""
    random = np.random.default_rng(seed)
    lights = some_light(random, shape, aspect, offset, np.pi)
    points = some_points(random, lights, 10.0**exponent)
    normals = single(
        unit(lights.position[0] - points) if exponent > 0.0 else np.tile(-lights.normal[0], (RECEIVERS, 1))
    )
    truth, slack = conditioned(lights, points, normals)
    off = np.abs(shader(lights, points, normals) - truth)
    assert (off <= 1e-5 * truth + rounding(lights, points) + 4.0 * slack).all()


@BOTH_SHAPES
@settings(max_examples=60, deadline=None, derandomize=True)
@given(seed=seeds, exponent=st.floats(-6.0, 6.0), aspect=ASPECTS, offset=OFFSETS)
def test_a_horizon_cuts_the_light_where_it_is(shader, shape, seed, exponent, aspect, offset):
    """Within 3e-4 of what a receiver that faces it gets; 2 % where the light is a thousand times closer than wide."""
    random = np.random.default_rng(seed)
    lights = some_light(random, shape, aspect, offset, np.pi)
    points = some_points(random, lights, 10.0**exponent)
    towards = unit(lights.position[0] - points)
    normals = single(unit(towards + random.choice([1.0, 5.0], (RECEIVERS, 1)) * random.normal(size=(RECEIVERS, 3))))
    truth, slack = conditioned(lights, points, normals)
    facing = np.array([irradiance(p, n, lights) for p, n in zip(points, towards, strict=True)])
    within = (3e-4, 0.0) if exponent > -3.0 else (2e-2, 1e-6)
    off = np.abs(shader(lights, points, normals) - truth)
    assert (off <= within[0] * np.maximum(truth, facing) + within[1] + rounding(lights, points) + 4.0 * slack).all()


@BOTH_SHAPES
@pytest.mark.parametrize("distance", [30.0, 100.0, 300.0, 1e4])
def test_a_small_light_cut_by_the_horizon(shader, shape, distance):
    """Within 3e-4 of what a receiver that faces it gets."""
    lights = light(shape, (0.0, 0.0, 0.0))
    points = np.tile(single(distance * unit(np.array([0.3, 0.5, -0.8]))), (RECEIVERS, 1))
    towards, angle = unit(-points), np.linspace(0.0, np.pi, RECEIVERS)[:, None]
    along = unit(np.cross(towards, [0.0, 0.0, 1.0]))
    across = np.cos(angle) * along + np.sin(angle) * np.cross(towards, along)
    normals = single(unit(across + np.linspace(-0.3, 0.3, RECEIVERS)[:, None] / distance * towards))
    truth = [irradiance(p, n, lights) for p, n in zip(points, normals, strict=True)]
    facing = irradiance(points[0], towards[0], lights)
    assert shader(lights, points, normals) == pytest.approx(np.array(truth), abs=3e-4 * facing)


@BOTH_SHAPES
@pytest.mark.parametrize("distance", [0.01, 0.1, 1.0])
def test_a_thin_light_is_correct(shader, shape, distance):
    """Aspect 1 : 1000, from receivers in front of its middle, its end and its side."""
    lights = light(shape, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, -1e-3, 0.0))
    points = single(np.array([(x, y, -distance) for x in (0.0, 0.45, 1.0) for y in (0.0, distance)]))
    normals = single(unit(-points))
    truth = [irradiance(p, n, lights) for p, n in zip(points, normals, strict=True)]
    assert shader(lights, points, normals) == pytest.approx(np.array(truth), rel=5e-4)


@BOTH_SHAPES
@settings(max_examples=30, deadline=None, derandomize=True)
@given(
    seed=seeds,
    degrees=st.sampled_from([1.0, 10.0, 40.0, 90.0, 120.0, 150.0, 175.0]),
    exponent=st.floats(-2.0, 2.5),
    aspect=st.sampled_from([1.0, 0.5, 0.2]),
)
def test_a_spread_is_integrated(shader, shape, seed, degrees, exponent, aspect):
    """Within 2e-4 (rectangle) or 2 % (ellipse) of the brightest receiver at this height; most within 2e-3."""
    random = np.random.default_rng(seed)
    lights = some_light(random, shape, aspect, 0.0, np.radians(degrees))
    u, v, normal = lights.axis_u[0], lights.axis_v[0], unit(lights.normal[0])
    height = 10.0**exponent * np.linalg.norm(u)
    across = random.uniform(-1.0, 1.0, (RECEIVERS, 2)) * (0.5 + 0.7 * 10.0**exponent * np.tan(lights.spread[0] / 2.0))
    points = single(lights.position[0] + height * normal + across @ np.stack([u, np.linalg.norm(u) * unit(v)]))
    normals = single(unit(-normal + 0.5 * random.normal(size=(RECEIVERS, 3))))
    truth = np.array([spread_integral(p, n, lights) for p, n in zip(points, unit(normals), strict=True)])
    brightest = spread_integral(lights.position[0] + height * normal, -normal, lights)
    off = np.abs(shader(lights, points, normals) - truth) / brightest
    within = 2e-2 if shape == LightShape.ELLIPSE else 2e-4
    assert off.max() < within and np.median(off) < 2e-3


@BOTH_SHAPES
@pytest.mark.parametrize("degrees", [10.0, 40.0, 90.0])
@pytest.mark.parametrize("size", [0.04, 0.06, 0.1, 0.2, 0.3])
def test_lights_that_are_almost_small_have_their_spread_integrated(shader, shape, degrees, size):
    """Lights of `size` times the cone's radius at the receivers: below middle, edge and corner, and at the cone's rim.

    The approximation by a few points is for small lights only. The error is below 0.3 % of the brightest receiver.
    """
    height, tangent = 2.0, np.tan(np.radians(degrees) / 2.0)
    across = size * min(tangent, 1.0) * height
    lights = light(shape, (0.0, 0.0, 0.0), (across, 0.0, 0.0), (0.0, -across, 0.0), spread=np.radians(degrees))
    around = np.array([(0.0, 0.0), (0.5, 0.0), (0.0, -0.5), (0.5, 0.5), (1.0, 0.5)]) * across
    rim = np.array([(0.9, 0.0), (1.0, 0.0), (0.6, 0.8)]) * tangent * height
    points = np.pad(np.concatenate([around, rim]), ((0, 0), (0, 1)), constant_values=-height)
    normals = np.tile((0.0, 0.0, 1.0), (len(points), 1))
    truth = np.array([spread_integral(p, n, lights) for p, n in zip(points, normals, strict=True)])
    error = np.abs(shader(lights, points, normals) - truth) / truth.max()
    assert error.max() < 3e-3


@pytest.mark.parametrize("seed", range(20))
def test_a_spread_is_integrated_below_edges_and_corners(shader, seed):
    """Of lights that point anywhere: rounding moves receivers to either side of an edge."""
    random = np.random.default_rng(seed)
    axes, _ = np.linalg.qr(random.normal(size=(3, 3)))
    u, v = random.uniform(0.1, 0.3, 2)[:, None] * axes[:2]
    lights = light(LightShape.RECTANGLE, (0.0, 0.0, 0.0), single(u), single(v), spread=np.radians(90.0))
    normal = lights.normal[0]
    offsets = [(x, y) for x in (-0.5, 0.0, 0.5) for y in (-0.5, 0.0, 0.5) if (x, y) != (0.0, 0.0)]
    points = single(np.array(offsets) @ np.stack([u, v]) + 2.0 * normal)
    normals = np.tile(-normal, (len(points), 1))
    truth = np.array([spread_integral(p, n, lights) for p, n in zip(points, normals, strict=True)])
    assert shader(lights, points, normals) == pytest.approx(truth, rel=2e-3)  # the reference's error at corners


@BOTH_SHAPES
@pytest.mark.parametrize("spread", [np.pi, np.radians(60.0), 0.0])
def test_irradiance_is_zero_behind_in_the_plane_facing_away_and_outside_the_cone(shader, shape, spread):
    lights = light(shape, (0.0, 0.0, 0.0), spread=spread)
    points = np.array([(0.1, 0.0, 1.0), (0.1, 0.1, 0.0), (0.1, 0.0, -1.0), (9.0, 0.0, -1.0)])
    normals = np.array([(0.0, 0.0, -1.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (0.0, 0.0, 1.0)])
    assert not shader(lights, points, normals)[: 4 if spread < np.pi else 3].any()


@BOTH_SHAPES
def test_a_light_without_a_spread_shines_straight_ahead(shader, shape):
    """P / A = pi L under it, and nothing beside it."""
    lights = light(shape, (0.0, 0.0, 0.0), spread=0.0)
    assert np.tan(MIN_SPREAD) < 0.01
    points, up = np.array([(0.2, 0.1, -1.0), (0.6, 0.0, -1.0)]), np.tile([0.0, 0.0, 1.0], (2, 1))
    assert shader(lights, points, up) == pytest.approx([np.pi, 0.0], rel=1e-5)
