# SPDX-License-Identifier: GPL-3.0-or-later
"""Points on triangles and lights: their distribution, their counts, and that they are the same each time."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ism_addon.gpu.lights.area import AreaLight
from ism_addon.sampling.points import (
    POINTS_AT_A_TIME,
    barycentric,
    disk,
    lattice,
    points_on_triangles,
    proportional_counts,
    triangle_areas,
)
from ism_addon.scene import LightShape
from tests.support.small_scenes import AREA_SHAPES, light

SHAPES = AREA_SHAPES


def chi_square_deviations(counts: np.ndarray, expected: np.ndarray) -> float:
    """Chi-square as standard deviations of a normal distribution (Wilson & Hilferty 1931). Above 4 is significant."""
    square, freedom = ((counts - expected) ** 2 / expected).sum(), len(counts) - 1
    spread = 2.0 / (9.0 * freedom)
    return float(((square / freedom) ** (1.0 / 3.0) - (1.0 - spread)) / np.sqrt(spread))


def uneven_triangles(count: int = 40) -> np.ndarray:
    """(T,3,3) triangles whose areas differ by a factor of several hundred."""
    random = np.random.default_rng(5)
    return random.normal(size=(count, 3, 3)) * random.uniform(0.1, 2.0, (count, 1, 1))


def test_triangles_are_chosen_by_area():
    corners = uneven_triangles()
    chosen, _ = points_on_triangles(corners, 200_000)
    areas = triangle_areas(corners)
    assert chi_square_deviations(np.bincount(chosen, minlength=40), areas / areas.sum() * 200_000) < 4.0


def test_chi_square_detects_another_weighting():
    corners = uneven_triangles()
    areas = triangle_areas(corners)
    chosen, _ = points_on_triangles(corners, 200_000)
    assert (
        chi_square_deviations(np.bincount(chosen, minlength=40), np.sqrt(areas) / np.sqrt(areas).sum() * 200_000)
        > 100.0
    )


def test_barycentric_coordinates_are_uniform():
    coordinates = barycentric(np.random.default_rng(1).random((100_000, 2)))
    assert np.allclose(coordinates.sum(1), 1.0, atol=1e-14)
    assert coordinates.min() >= 0.0
    # Sixteen equal cells: four strips along one side, each cut into its 2 k + 1 triangles.
    strip, along = np.floor(4.0 * coordinates[:, 0]).clip(max=3), np.floor(4.0 * coordinates[:, 1])
    upper = np.floor(4.0 * coordinates[:, 2])
    _, counts = np.unique(np.column_stack([strip, along, upper]), axis=0, return_counts=True)
    assert len(counts) == 16
    assert chi_square_deviations(counts, np.full(16, 100_000 / 16)) < 4.0


def test_points_lie_in_the_plane_of_their_triangle():
    corners = uneven_triangles()
    chosen, points = points_on_triangles(corners, 5_000)
    a, b, c = np.moveaxis(corners[chosen], 1, 0)
    normal = np.cross(b - a, c - a)
    assert np.abs(((points - a) * normal).sum(1) / np.linalg.norm(normal, axis=1)).max() < 1e-12


def test_points_are_evenly_distributed_on_one_large_triangle():
    _, points = points_on_triangles(np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]]), 4096)
    cells = np.floor(points[:, :2] * 8).astype(int)
    inside = cells.sum(1) < 7  # cells that lie within the triangle
    counts = np.bincount(cells[inside] @ (1, 8), minlength=64)
    expected = 2.0 * 4096 / 64
    assert np.abs(counts[counts > 0] - expected).max() < 0.2 * expected  # random points: up to 0.27


def test_the_same_mesh_gives_the_same_points_and_any_slice_of_them():
    corners = uneven_triangles()
    points, some = points_on_triangles(corners, 3_000), points_on_triangles(corners, 500, first=1_000)
    again = points_on_triangles(corners.copy(), 3_000)
    for one, other, sliced in zip(points, again, some, strict=True):
        assert np.array_equal(one, other)
        assert np.array_equal(one[1_000:1_500], sliced)


def test_portions_of_points_are_continuous():
    corners = uneven_triangles(3)
    chosen, points = points_on_triangles(corners, POINTS_AT_A_TIME + 10)
    last = points_on_triangles(corners, 20, first=POINTS_AT_A_TIME - 10)
    assert np.array_equal(chosen[-20:], last[0])
    assert np.array_equal(points[-20:], last[1])


def test_triangles_without_area_get_no_points():
    corners = np.zeros((3, 3, 3))
    corners[1] = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    chosen, points = points_on_triangles(corners, 1_000)
    assert set(chosen) == {1}
    assert np.isfinite(points).all()


@settings(deadline=None, derandomize=True)
@given(st.lists(st.floats(0.0, 1e6), min_size=1, max_size=60), st.integers(0, 100_000))
def test_proportional_counts_sum_to_the_count_and_differ_by_less_than_one(weights, count):
    weights = np.array(weights)
    counts = proportional_counts(weights, count)
    assert counts.min() >= 0
    if weights.sum() > 0.0:
        assert counts.sum() == count
        assert np.abs(counts - weights / weights.sum() * count).max() < 1.0 + 1e-6
    else:
        assert not counts.any()


def on_light(lights, points: np.ndarray) -> np.ndarray:
    """(N,2) coordinates along the axes, each from -0.5 to 0.5."""
    axes = np.stack([lights.axis_u[0], lights.axis_v[0]])
    offsets = points - lights.position[0]
    assert np.abs(offsets @ lights.normal[0]).max() < 1e-12
    return offsets @ axes.T / (axes**2).sum(1)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.37, 0.91), (5.5, 3.25)])
def test_points_on_a_light_are_inside_it_and_uniform(shape, shift):
    lights = light(shape, (1.0, 2.0, 3.0), (0.0, 2.0, 0.0), (0.3, 0.0, 0.4))
    across = on_light(
        lights, lights.position[0] + AreaLight().virtual_lights(lights, 0, lattice(4096, np.array(shift)))[0]
    )
    radius = np.linalg.norm(across, axis=1) if shape == LightShape.ELLIPSE else np.abs(across).max(1)
    assert radius.max() <= 0.5
    angle, ring = np.arctan2(*across.T), (2.0 * radius) ** 2  # rings of equal areas, in both shapes
    assert chi_square_deviations(np.histogram(ring, 16, (0.0, 1.0))[0], np.full(16, 256.0)) < 4.0
    assert chi_square_deviations(np.histogram(angle, 4, (-np.pi, np.pi))[0], np.full(4, 1024.0)) < 4.0


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("count", [16, 105, 256])
def test_points_on_a_light_integrate_with_less_error_than_random_ones(shape, count):
    lights = light(shape, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    random = np.random.default_rng(count)

    def visibility(points: np.ndarray) -> float:
        """The fraction of the light that is visible beside one straight edge."""
        return (points[:, 0] * 0.8 + points[:, 1] * 0.6 < 0.1).mean()

    shifts = random.random((64, 2))
    truth = visibility(AreaLight().virtual_lights(lights, 0, lattice(1 << 16, np.zeros(2)))[0])
    ours = np.array([visibility(AreaLight().virtual_lights(lights, 0, lattice(count, shift))[0]) for shift in shifts])
    squares = random.random((64, count, 2))
    by_random = np.array([visibility(disk(s) if shape == LightShape.ELLIPSE else s - 0.5) for s in squares])
    assert np.sqrt(((ours - truth) ** 2).mean()) < 0.5 * np.sqrt(((by_random - truth) ** 2).mean())


def test_disk_preserves_areas_and_has_no_singularity():
    points = disk(np.random.default_rng(3).random((100_000, 2)))
    assert np.histogram(np.linalg.norm(points, axis=1) * 2.0, 2, (0.0, np.sqrt(0.5)))[0].sum() == pytest.approx(
        50_000, rel=0.02
    )
    assert np.isfinite(disk(np.array([[0.5, 0.5]]))).all()
