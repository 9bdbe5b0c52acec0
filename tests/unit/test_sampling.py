# SPDX-License-Identifier: GPL-3.0-or-later
"""Points are where they should be, as many as they should be, and the same each time."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ism_addon.gpu.lights.area import AreaLight
from ism_addon.sampling import (
    PIXEL_GRIDS,
    POINTS_AT_A_TIME,
    Dimension,
    barycentric,
    disk,
    lattice,
    narrow_pixel_grid,
    pixel_grid,
    points_on_triangles,
    proportional_counts,
    rd_sequence,
    sequence,
    triangle_areas,
)
from ism_addon.scene import LightShape
from tests.support.small_scenes import light
from tests.tools import project

SHAPES = tuple(LightShape)


def surprise(counts: np.ndarray, expected: np.ndarray) -> float:
    """Chi-square as standard deviations of a normal distribution (Wilson & Hilferty 1931): above 4 is no accident."""
    square, freedom = ((counts - expected) ** 2 / expected).sum(), len(counts) - 1
    spread = 2.0 / (9.0 * freedom)
    return float(((square / freedom) ** (1.0 / 3.0) - (1.0 - spread)) / np.sqrt(spread))


def uneven_triangles(count: int = 40) -> np.ndarray:
    """(T,3,3) whose areas differ by a factor of some hundreds."""
    random = np.random.default_rng(5)
    return random.normal(size=(count, 3, 3)) * random.uniform(0.1, 2.0, (count, 1, 1))


def test_triangles_are_chosen_by_area():
    corners = uneven_triangles()
    chosen, _ = points_on_triangles(corners, 200_000)
    areas = triangle_areas(corners)
    assert surprise(np.bincount(chosen, minlength=40), areas / areas.sum() * 200_000) < 4.0


def test_surprise_notices_another_weighting():
    corners = uneven_triangles()
    areas = triangle_areas(corners)
    chosen, _ = points_on_triangles(corners, 200_000)
    assert surprise(np.bincount(chosen, minlength=40), np.sqrt(areas) / np.sqrt(areas).sum() * 200_000) > 100.0


def test_barycentric_coordinates_are_uniform():
    coordinates = barycentric(np.random.default_rng(1).random((100_000, 2)))
    assert np.allclose(coordinates.sum(1), 1.0, atol=1e-14)
    assert coordinates.min() >= 0.0
    # Sixteen equal parts: four strips along one side, each cut into its 2 k + 1 triangles.
    strip, along = np.floor(4.0 * coordinates[:, 0]).clip(max=3), np.floor(4.0 * coordinates[:, 1])
    upper = np.floor(4.0 * coordinates[:, 2])
    parts = np.unique(np.column_stack([strip, along, upper]), axis=0, return_counts=True)
    assert len(parts[1]) == 16
    assert surprise(parts[1], np.full(16, 100_000 / 16)) < 4.0


def test_points_lie_in_the_plane_of_their_triangle():
    corners = uneven_triangles()
    chosen, points = points_on_triangles(corners, 5_000)
    a, b, c = np.moveaxis(corners[chosen], 1, 0)
    normal = np.cross(b - a, c - a)
    assert np.abs(((points - a) * normal).sum(1) / np.linalg.norm(normal, axis=1)).max() < 1e-12


def test_points_spread_evenly_on_one_large_triangle():
    _, points = points_on_triangles(np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]]), 4096)
    cells = np.floor(points[:, :2] * 8).astype(int)
    whole = cells.sum(1) < 7  # cells that lie within the triangle
    counts = np.bincount(cells[whole] @ (1, 8), minlength=64)
    expected = 2.0 * 4096 / 64
    assert np.abs(counts[counts > 0] - expected).max() < 0.2 * expected  # random points: up to 0.27


def test_the_same_mesh_gives_the_same_points_and_any_slice_of_them():
    corners = uneven_triangles()
    whole, part = points_on_triangles(corners, 3_000), points_on_triangles(corners, 500, first=1_000)
    again = points_on_triangles(corners.copy(), 3_000)
    for one, other, sliced in zip(whole, again, part, strict=True):
        assert np.array_equal(one, other)
        assert np.array_equal(one[1_000:1_500], sliced)


def test_blocks_join_without_a_seam():
    corners = uneven_triangles(3)
    chosen, points = points_on_triangles(corners, POINTS_AT_A_TIME + 10)
    late = points_on_triangles(corners, 20, first=POINTS_AT_A_TIME - 10)
    assert np.array_equal(chosen[-20:], late[0])
    assert np.array_equal(points[-20:], late[1])


def test_triangles_without_area_get_no_points():
    corners = np.zeros((3, 3, 3))
    corners[1] = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    chosen, points = points_on_triangles(corners, 1_000)
    assert set(chosen) == {1}
    assert np.isfinite(points).all()


@settings(deadline=None, derandomize=True)
@given(st.lists(st.floats(0.0, 1e6), min_size=1, max_size=60), st.integers(0, 100_000))
def test_shares_sum_to_the_count_and_are_due(weights, count):
    weights = np.array(weights)
    dealt = proportional_counts(weights, count)
    assert dealt.min() >= 0
    if weights.sum() > 0.0:
        assert dealt.sum() == count
        assert np.abs(dealt - weights / weights.sum() * count).max() < 1.0 + 1e-6
    else:
        assert not dealt.any()


def on_light(lights, points: np.ndarray) -> np.ndarray:
    """(N,2) along the axes, each from -0.5 to 0.5."""
    axes = np.stack([lights.axis_u[0], lights.axis_v[0]])
    off = points - lights.position[0]
    assert np.abs(off @ lights.normal[0]).max() < 1e-12
    return off @ axes.T / (axes**2).sum(1)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.37, 0.91), (5.5, 3.25)])
def test_points_on_a_light_are_inside_it_and_uniform(shape, shift):
    lights = light(shape, (1.0, 2.0, 3.0), (0.0, 2.0, 0.0), (0.3, 0.0, 0.4))
    across = on_light(lights, lights.position[0] + AreaLight().points(lights, 0, lattice(4096, np.array(shift))))
    radius = np.linalg.norm(across, axis=1) if shape == LightShape.ELLIPSE else np.abs(across).max(1)
    assert radius.max() <= 0.5
    angle, ring = np.arctan2(*across.T), (2.0 * radius) ** 2  # rings of equal areas, in both shapes
    assert surprise(np.histogram(ring, 16, (0.0, 1.0))[0], np.full(16, 256.0)) < 4.0
    assert surprise(np.histogram(angle, 4, (-np.pi, np.pi))[0], np.full(4, 1024.0)) < 4.0


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("count", [16, 105, 256])
def test_points_on_a_light_integrate_better_than_random_ones(shape, count):
    lights = light(shape, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    random = np.random.default_rng(count)

    def lit(points: np.ndarray) -> float:
        """The part of the light that one straight edge leaves visible."""
        return (points[:, 0] * 0.8 + points[:, 1] * 0.6 < 0.1).mean()

    shifts = random.random((64, 2))
    truth = lit(AreaLight().points(lights, 0, lattice(1 << 16, np.zeros(2))))
    ours = np.array([lit(AreaLight().points(lights, 0, lattice(count, shift))) for shift in shifts])
    squares = random.random((64, count, 2))
    theirs = np.array([lit(disk(s) if shape == LightShape.ELLIPSE else s - 0.5) for s in squares])
    assert np.sqrt(((ours - truth) ** 2).mean()) < 0.5 * np.sqrt(((theirs - truth) ** 2).mean())


def test_disk_keeps_areas_and_has_no_pole():
    points = disk(np.random.default_rng(3).random((100_000, 2)))
    assert np.histogram(np.linalg.norm(points, axis=1) * 2.0, 2, (0.0, np.sqrt(0.5)))[0].sum() == pytest.approx(
        50_000, rel=0.02
    )
    assert np.isfinite(disk(np.array([[0.5, 0.5]]))).all()


@pytest.mark.parametrize("first", [0, 3000])
def test_no_two_decisions_follow_each_other(first):
    """Of each two, all pairs of numbers come up, evenly: neither is the other's, its double or what is left of it."""
    assert len(Dimension) == len(Dimension.__members__), "of equal increments Python makes one member"
    numbers = {
        f"{each.name} {k}": column for each in Dimension for k, column in enumerate(sequence(each, first, 1024).T)
    }
    for (one, x), (other, y) in combinations(numbers.items(), 2):
        counts, _, _ = np.histogram2d(x, y, 8, ((0.0, 1.0), (0.0, 1.0)))
        assert counts.min() >= 4 and counts.max() <= 32, (one, other)  # 16 on average


def test_every_decision_has_one_place():
    """Two that took the same dimension would follow each other."""
    texts = [path.read_text("utf-8") for path in (project.ROOT / "ism_addon").rglob("*.py")]
    for dimension in Dimension:
        assert sum(text.count(f"Dimension.{dimension.name}") for text in texts) == 1, dimension


def test_every_run_of_the_sequence_is_evenly_spread():
    for first in (0, 17, 100_000):
        values = rd_sequence(first, 64, 2)
        for column in np.sort(values, axis=0).T:
            assert np.diff(column, append=column[0] + 1.0).max() < 4.0 / 64  # random ones leave gaps of 5


def places(samples: int, count: int) -> np.ndarray:
    """(samples,2) px off the pixel's centre."""
    return np.concatenate([pixel_grid(number, count).places for number in range(samples // count)])


@pytest.mark.parametrize("count", PIXEL_GRIDS)
def test_places_fill_the_pixel_evenly(count):
    offsets = places(8192, count)
    assert np.abs(offsets).max() <= 0.5
    assert np.abs(offsets.mean(0)).max() < 2e-3
    assert offsets.var(0) == pytest.approx(1.0 / 12.0, rel=0.01)
    assert abs(np.corrcoef(offsets.T)[0, 1]) < 0.01


@pytest.mark.parametrize("count", PIXEL_GRIDS)
def test_the_first_place_is_the_centre(count):
    assert not pixel_grid(0, count).off.any()
    assert not pixel_grid(0, count).places[0].any()


@pytest.mark.parametrize("count", PIXEL_GRIDS)
def test_the_places_of_a_grid_are_the_fine_pixels_of_a_pixel(count):
    """Of each pixel others, and of all pixels together all that lie in the picture."""
    grids = [pixel_grid(number, count) for number in (0, 1, 5, 77)]
    for one in grids:
        assert np.linalg.det(one.fine_from_pixel) == pytest.approx(count)
        assert one.texels == pytest.approx((one.places - one.off) @ one.fine_from_pixel.T, abs=1e-9)
        pixels = np.stack(np.meshgrid(np.arange(9), np.arange(7)), -1).reshape(-1, 1, 2)
        first, size = one.bounds(9, 7)
        fine = (pixels @ one.fine_from_pixel.T + first + one.texels).reshape(-1, 2)
        assert len({tuple(texel) for texel in fine}) == 9 * 7 * count
        assert (fine.min(0) == 0).all() and (fine.max(0) == size - 1).all()
    assert len({tuple(one.off) for one in grids}) == len(grids)


@pytest.mark.parametrize("count", PIXEL_GRIDS)
def test_all_grids_of_as_many_places_fit_into_the_room_of_each(count):
    """And nearly fill it: a picture needs memory for its fine pixels once."""
    grids = [pixel_grid(number, count) for number in range(500)]
    sizes = np.array([one.bounds(9, 7)[1] for one in grids])
    rooms = np.array([one.room(9, 7) for one in grids])
    assert (rooms == rooms[0]).all()
    assert (sizes.max(0) <= rooms[0]).all()
    assert (sizes.max(0) >= rooms[0] - 3).all()


@pytest.mark.parametrize("count", PIXEL_GRIDS)
def test_a_fine_pixel_shows_what_is_at_its_place(count):
    """In clip coordinates: from a place in the picture to the centre of its pixel in the fine one."""
    one, size = pixel_grid(3, count), np.array([9, 7])
    turn, shift = one.fine_from_clip(*size)
    first, fine_size = one.bounds(*size)
    for pixel in ([0, 0], [8, 6], [3, 5]):
        for place, texel in zip(one.places, one.texels, strict=True):
            clip = 2.0 * (np.array(pixel) + 0.5 + place) / size - 1.0
            fine = (0.5 * (turn @ clip + shift) + 0.5) * fine_size
            assert fine == pytest.approx(one.fine_from_pixel @ pixel + first + texel + 0.5, abs=1e-9)


def test_a_turned_grid_has_a_place_on_each_line_along_the_pixels_sides():
    for column in pixel_grid(0, 16).places.T:
        assert len(set(np.round(column, 6))) == 16


def test_the_first_few_places_are_spread_as_all_are():
    """Of four one in each quarter along either side, of eight one in each eighth."""
    for few in (4, 8):
        for column in pixel_grid(0, 16).places[:few].T:
            assert len(set(np.floor((column + 0.5) * few + 1e-9))) == few


@pytest.mark.parametrize("reach", [0.01, 0.5])
def test_a_narrow_filter_is_followed_by_the_places_themselves(reach):
    offsets = np.concatenate([narrow_pixel_grid(number, reach).places for number in range(4096)])
    assert np.abs(offsets[0]).max() < 1e-12
    assert np.abs(offsets).max() <= reach
    t = np.linspace(-1.0, 1.0, 4001)
    k = np.pi * (t + 1.0)
    weight = 0.35875 - 0.48829 * np.cos(k) + 0.14128 * np.cos(2 * k) - 0.01168 * np.cos(3 * k)
    assert np.abs(offsets.mean(0)).max() < 0.01 * reach
    assert offsets.var(0) == pytest.approx(reach**2 * (weight * t**2).sum() / weight.sum(), rel=0.02)
