# SPDX-License-Identifier: GPL-3.0-or-later
"""Suns: irradiance against an integral, bounds of irradiance and of shadow rays, occluders of parallel maps."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ism_addon.gpu.culling.receiver_region import ReceiverRegion
from ism_addon.gpu.culling.shaft_culling import meets_shaft
from ism_addon.gpu.culling.surface_bounds import SurfaceBounds
from ism_addon.gpu.lights.sun import SunLight, SunLightBounds
from ism_addon.scene import Lights, LightShape
from tests.support.reference_irradiance import cap_integral
from tests.support.small_scenes import light

from .conftest import RECEIVERS

ORIGIN = np.zeros(3)
#: rad
ANGLES = st.sampled_from([0.0, 1e-3, 0.0092, 0.1, 1.0, 2.5, np.pi])
seeds = st.integers(0, 1 << 30)
fast = settings(max_examples=100, deadline=None, derandomize=True)


def some_sun(random: np.random.Generator, angle: float) -> Lights:
    axes, _ = np.linalg.qr(random.normal(size=(3, 3)))
    return light(LightShape.SUN, ORIGIN, axes[0], axes[1], spread=angle)


def some_normals(random: np.random.Generator, sun: Lights, count: int) -> np.ndarray:
    """(N,3): half of them have the sun at their horizon."""
    tilt = np.where(np.arange(count) % 2, np.pi / 2.0 + random.uniform(-1.2, 1.2, count) * sun.spread[0] / 2.0, 0.3)
    around = random.uniform(0.0, 2.0 * np.pi, count)
    lateral = np.cos(around)[:, None] * sun.axis_u + np.sin(around)[:, None] * sun.axis_v
    return np.float32(np.sin(tilt)[:, None] * lateral - np.cos(tilt)[:, None] * sun.normal).astype(float)


def directions_in(random: np.random.Generator, sun: Lights, count: int) -> np.ndarray:
    """(N,3) unit: towards points of the sun."""
    radius = np.sqrt(random.uniform(size=count)) * np.sin(sun.spread[0] / 2.0)
    around = random.uniform(0.0, 2.0 * np.pi, count)
    across = radius * np.stack([np.cos(around), np.sin(around)])
    return across.T @ np.concatenate([sun.axis_u, sun.axis_v]) - np.sqrt(1.0 - radius**2)[:, None] * sun.normal


@fast
@given(seed=seeds, angle=ANGLES)
def test_irradiance_is_exact(shader, seed, angle):
    random = np.random.default_rng(seed)
    sun = some_sun(random, angle)
    normals = some_normals(random, sun, RECEIVERS)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    sine = np.sin(np.float64(np.float32(angle)) / 2.0)
    cosines = np.clip(-normals @ sun.normal[0], -1.0, 1.0)
    expected = [cap_integral(each, sine) / (np.pi * sine**2) if sine else max(each, 0.0) for each in cosines]
    assert shader(sun, np.zeros((RECEIVERS, 3)), normals) == pytest.approx(expected, abs=2e-6)


@fast
@given(seed=seeds, angle=ANGLES, variation=st.sampled_from([0.0, 0.1, 1.0, 5.0]))
def test_no_sun_is_brighter_than_its_bound(shader, seed, angle, variation):
    random = np.random.default_rng(seed)
    sun = some_sun(random, angle)
    normals = some_normals(random, sun, RECEIVERS)
    normals = normals[0] + variation * normals
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    facing = np.append(normals[0], (normals @ normals[0]).min())
    rows = np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(4), facing
    surfaces = SurfaceBounds.of(*(row.astype(np.float32)[None, None] for row in rows))
    (bound,), _ = SunLightBounds.of(sun).irradiance(surfaces)
    assert shader(sun, np.zeros((RECEIVERS, 3)), normals).max() <= 1.0001 * bound[0] + 1e-9


@fast
@given(seed=seeds, angle=ANGLES, distance=st.floats(-1.0, 6.0))
def test_shafts_contain_all_shadow_rays(seed, angle, distance):
    random = np.random.default_rng(seed)
    sun = some_sun(random, angle)
    receivers = np.sort(random.normal(size=(2, 3, 1)), 0)
    ends = SunLight().shadow_ends(sun, ORIGIN, receivers)[:, :, 0]
    starts = random.uniform(*receivers[..., 0], (50, 3))
    points = starts + 10.0**distance * directions_in(random, sun, 50)
    assert meets_shaft(np.stack([points.T, points.T]), ends, receivers).all()


@fast
@given(seed=seeds, angle=ANGLES, distance=st.floats(-1.0, 3.0))
def test_every_occluder_has_a_weight(seed, angle, distance):
    """Every point on a ray from the region to the sun."""
    random = np.random.default_rng(seed)
    sun, region = some_sun(random, min(angle, 2.5)), ReceiverRegion((0.3, -0.2, 0.1), 2.0)
    starts = random.normal(size=(50, 3))
    starts *= random.uniform(0.0, region.radius, (50, 1)) / np.linalg.norm(starts, axis=1, keepdims=True)
    points = region.centre + starts + 10.0**distance * directions_in(random, sun, 50)
    normals = np.tile(np.float32([[0.0, 0.0, 1.0]]), (50, 1))
    assert SunLight().solid_angles(sun, 0, ORIGIN, np.float32(points), normals, 0.01, region).all()


def test_points_beside_and_below_the_region_have_no_weight():
    sun, region = light(LightShape.SUN, ORIGIN, spread=0.0), ReceiverRegion((0.0, 0.0, 0.0), 2.0)
    points = np.float32([[0.0, 0.0, 50.0], [0.0, 0.0, -2.5], [2.5, 0.0, 1.0], [1.9, 0.0, 1.0]])
    weights = SunLight().solid_angles(sun, 0, ORIGIN, points, np.float32([[0.0, 0.0, 1.0]] * 4), 0.01, region)
    assert (weights > 0.0).tolist() == [True, False, False, True]


def test_the_region_contains_all_surfaces_and_seldom_changes():
    random = np.random.default_rng(0)
    middle, regions = random.normal(size=3), []
    for _ in range(100):
        moved = np.float32(middle + 0.005 * random.normal(size=3))
        points = moved[:, None] + np.float32([[-1.0, 2.0], [0.5, 1.0], [0.0, 0.5]])
        surfaces = SurfaceBounds.around(points, np.eye(3)[:, :2])
        regions.append(ReceiverRegion.around(surfaces))
        distances = np.linalg.norm(surfaces.low - np.array(regions[-1].centre)[:, None], axis=0)
        assert distances.max() <= regions[-1].radius < 1.6 * distances.max()
    assert len(set(regions)) <= 4


def test_without_surfaces_there_is_a_region_all_the_same():
    nothing = SurfaceBounds.around(np.zeros((3, 2), np.float32), np.zeros((3, 2), np.float32))
    nothing.exists[:] = False
    assert ReceiverRegion.around(nothing).radius == 1.0
