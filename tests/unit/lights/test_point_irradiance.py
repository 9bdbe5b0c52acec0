# SPDX-License-Identifier: GPL-3.0-or-later
"""The shader's unshadowed irradiance of point lights against float64, from inside to a million radii away."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ism_addon.gpu.culling.surface_bounds import SurfaceBounds
from ism_addon.gpu.lights.point import PointLightBounds
from ism_addon.gpu.lights.spot import SpotLight, SpotLightBounds
from ism_addon.scene import Lights, LightShape
from tests.support.reference_irradiance import point_irradiance
from tests.support.small_scenes import light

from .conftest import RECEIVERS

SOFT = pytest.mark.parametrize("soft", [False, True], ids=["sphere", "disk"])


def some_light(random: np.random.Generator, soft: bool, radius: float | None = None) -> Lights:
    """A point light about the origin, of random radius."""
    position = np.float32(random.normal(size=3)).astype(float)
    radius = 10.0 ** random.uniform(-2.0, 1.0) if radius is None else radius
    return light(LightShape.POINT, position, radius=float(np.float32(radius)), soft_falloff=soft)


def some_receivers(random: np.random.Generator, one: Lights, distance: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (N,3) at a distance from the light, and normals (N,3), many of which have the light at their horizon."""
    directions = random.normal(size=(RECEIVERS, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    points = np.float32(one.position[0] - distance * directions).astype(float)
    tangents = np.cross(directions, random.normal(size=(RECEIVERS, 3)))
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    extent = min(one.radius[0] / distance, 1.0)
    cosine = np.where(
        np.arange(RECEIVERS) % 2, random.uniform(-1.2, 1.2, RECEIVERS) * extent, random.uniform(-1.0, 1.0)
    )
    cosine = np.clip(cosine, -1.0, 1.0)[:, None]
    normals = np.float32(cosine * directions + np.sqrt(1.0 - cosine**2) * tangents).astype(float)
    return points, normals / np.linalg.norm(normals, axis=1, keepdims=True)


@SOFT
@settings(max_examples=60, deadline=None, derandomize=True)
@given(seed=st.integers(0, 1 << 30), exponent=st.floats(-1.0, 6.0))
def test_irradiance_is_exact(shader, soft, seed, exponent):
    """Within 1e-5 of the irradiance of a receiver that faces the light, which is what float32 makes of a cosine."""
    random = np.random.default_rng(seed)
    one = some_light(random, soft)
    points, normals = some_receivers(random, one, one.radius[0] * 10.0**exponent)
    distances = np.linalg.norm(one.position[0] - points, axis=1)
    either_side = (np.abs(distances / one.radius[0] - 1.0) < 1e-4) & ~one.soft_falloff  # float32 may take the other
    expected = np.array([point_irradiance(p, n, one) for p, n in zip(points, normals, strict=True)])
    facing = 1.0 / np.maximum(distances, one.radius[0]) ** 2
    difference = np.abs(shader(one, points, normals) - expected)
    assert (difference / facing)[~either_side].max(initial=0.0) < 1e-5 + 2e-7 * np.abs(
        one.position
    ).max() / distances.min()


def test_a_point_without_a_radius_is_exact(shader):
    random = np.random.default_rng(0)
    one = some_light(random, False, 0.0)
    points, normals = some_receivers(random, one, 2.0)
    expected = np.array([point_irradiance(p, n, one) for p, n in zip(points, normals, strict=True)])
    assert shader(one, points, normals) == pytest.approx(expected, rel=1e-5, abs=1e-6)


@SOFT
@settings(max_examples=100, deadline=None, derandomize=True)
@given(seed=st.integers(0, 1 << 30), exponent=st.floats(-2.0, 2.0), tilt=st.floats(0.0, 3.0))
def test_no_light_is_brighter_than_its_bound(soft, seed, exponent, tilt):
    random = np.random.default_rng(seed)
    one = some_light(random, soft, random.choice([0.0, 10.0 ** random.uniform(-2.0, 1.0)]))
    points = one.position[0] + 10.0**exponent * (random.normal(size=3) + random.uniform(-0.5, 0.5, (12, 3)))
    normals = random.normal(size=3) + tilt * random.normal(size=(12, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    low, high = np.append(points.min(0), 1.0), np.append(points.max(0), 0.0)
    facing = np.append(normals[0], (normals @ normals[0]).min())
    surfaces = SurfaceBounds.of(*(row.astype(np.float32)[None, None] for row in (low, high, facing)))
    (bound,), _ = PointLightBounds.of(one, np.zeros(3)).irradiance(surfaces)
    irradiances = [point_irradiance(p, n, one) for p, n in zip(points, normals, strict=True)]
    assert max(irradiances) <= 1.0001 * bound[0] + 1e-9


def test_far_from_a_light_the_estimate_is_accurate():
    one = light(LightShape.POINT, (0.7, -0.4, 3.0), radius=0.3)
    low, high = np.array([-0.05, -0.05, 0.0, 1.0]), np.array([0.05, 0.05, 0.0, 0.0])
    rows = low, high, np.array([0.0, 0.0, 1.0, 1.0])
    surfaces = SurfaceBounds.of(*(row.astype(np.float32)[None, None] for row in rows))
    (bound,), (estimate,) = PointLightBounds.of(one, np.zeros(3)).irradiance(surfaces)
    assert estimate[0] == pytest.approx(point_irradiance(np.zeros(3), np.array([0.0, 0.0, 1.0]), one), rel=0.02)
    assert estimate[0] < bound[0] < 1.5 * estimate[0]


@settings(max_examples=100, deadline=None, derandomize=True)
@given(
    seed=st.integers(0, 1 << 30),
    exponent=st.floats(-1.0, 1.5),
    spread=st.floats(0.0, np.pi),
    blend=st.sampled_from([0.0, 0.3, 1.0]),
    radius=st.sampled_from([0.0, 0.05, 0.5]),
)
def test_no_spot_is_brighter_than_its_bound(shader, seed, exponent, spread, blend, radius):
    """Many of the receivers are near the cone, which is elliptical or circular."""
    random = np.random.default_rng(seed)
    position, axes = np.float32(random.normal(size=3)).astype(float), np.linalg.qr(random.normal(size=(3, 3)))[0]
    size = random.choice([1.0, 0.5, 2.0], 2)
    one = light(
        *(LightShape.SPOT, position, size[0] * axes[0], size[1] * axes[1]),
        radius=float(np.float32(radius)),
        spread=spread,
        blend=blend,
    )
    tangent = np.tan(min(spread / 2.0, 1.5)) * random.uniform(0.0, 1.2)
    angle = random.uniform(0.0, 2.0 * np.pi)
    direction = one.normal[0] + tangent * (np.cos(angle) * one.axis_u[0] + np.sin(angle) * one.axis_v[0])
    points = position + 10.0**exponent * (direction + random.uniform(-0.3, 0.3, (RECEIVERS, 3)))
    normals = position - points + random.normal(size=(RECEIVERS, 3))
    points, normals = (np.float32(rows).astype(float) for rows in (points, normals))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    low, high = np.append(points.min(0), 1.0), np.append(points.max(0), 0.0)
    facing = np.append(normals[0], (normals @ normals[0]).min())
    surfaces = SurfaceBounds.of(*(row.astype(np.float32)[None, None] for row in (low, high, facing)))
    (bound,), _ = SpotLightBounds.of(one, np.zeros(3)).irradiance(surfaces)
    irradiances = shader(one, points, normals)
    assert irradiances.max() <= 1.0001 * bound[0] + 1e-6 * irradiances.max()
    boxes = np.stack([points.min(0), points.max(0)])[..., None]
    assert irradiances.max() == 0.0 or SpotLight().heights(one, np.zeros(3), boxes)[0, 0] > 0.0
