# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces of triangles: how they are split, and that no light is lost."""

import numpy as np
import pytest

from ism_addon.gpu.emission.pieces import PARTS, Pieces, depth_within, parts_at, points_in_parts, split

TRIANGLES = np.array([4, 7])
LIGHT, AREAS = np.array([0, 0]), np.array([2.0, 1.0])


def areas_of(corners: np.ndarray) -> np.ndarray:
    """(…): of barycentric corners (…,3,3), of the whole triangle; positive if they are in its order."""
    return np.linalg.det(corners)


def power(pieces: Pieces) -> np.ndarray:
    """(3,): radiance times area."""
    areas = areas_of(pieces.corners) * AREAS[np.searchsorted(TRIANGLES, pieces.triangle)]
    return (pieces.radiance * areas[:, None]).sum(0)


@pytest.mark.parametrize(("count", "limit", "depth"), [(2, 1024, 4), (1, 1024, 5), (256, 1024, 1), (257, 1024, 0)])
def test_depths_keep_the_limit(count, limit, depth):
    assert depth_within(count, limit) == depth


@pytest.mark.parametrize("depth", [0, 1, 3])
def test_parts_fill_their_triangle(depth):
    parts = parts_at(depth)
    assert np.allclose(areas_of(parts), PARTS**-depth), "in the same order of corners"
    assert np.allclose(parts.sum(2), 1.0) and parts.min() >= 0.0
    if depth:
        assert np.allclose(parts.reshape(-1, PARTS, 3, 3).mean((1, 2)), parts_at(depth - 1).mean(1))


def test_points_lie_in_their_parts_and_directions_above_them():
    points, directions = points_in_parts(3, 2)
    inside = np.einsum("pi,pij->pj", points, np.linalg.inv(np.tile(parts_at(2), (3, 1, 1))))
    assert inside.min() >= -1e-9 and np.allclose(points.sum(1), 1.0)
    assert np.allclose(np.linalg.norm(directions, axis=1), 1.0) and directions[:, 2].min() >= 0.0
    _, many = points_in_parts(64, 3)
    assert np.allclose(many.mean(0), (0.0, 0.0, 2.0 / 3.0), atol=0.01), "by their cosine"


def test_even_triangles_stay_whole():
    radiance = np.ones((2, PARTS**3, 3)) * [[[1.0, 2.0, 3.0]], [[5.0, 5.0, 5.0]]]
    pieces = split(TRIANGLES, LIGHT, AREAS, radiance * np.linspace(0.995, 1.005, PARTS**3)[:, None], 1024)
    assert pieces.triangle.tolist() == TRIANGLES.tolist()
    assert np.allclose(pieces.radiance, radiance[:, 0], rtol=0.01)


@pytest.mark.parametrize("max_pieces", [2, 20, 1000])
def test_the_light_of_pieces_is_that_of_the_points(max_pieces):
    radiance = np.random.default_rng(1).random((2, PARTS**4, 3)) ** 8
    pieces = split(TRIANGLES, LIGHT, AREAS, radiance, max_pieces)
    assert max_pieces - PARTS < len(pieces.triangle) <= max_pieces or len(pieces.triangle) == 2 * PARTS**3
    assert np.allclose(power(pieces), (radiance.mean(1) * AREAS[:, None]).sum(0))


def test_black_parts_are_left_out_and_bright_ones_are_split_first():
    radiance = np.zeros((2, PARTS**5, 3))
    radiance[0, 700:704], radiance[1, :512] = 1000.0, 0.01
    pieces = split(TRIANGLES, LIGHT, AREAS, radiance, 24)
    assert np.allclose(power(pieces), (radiance.mean(1) * AREAS[:, None]).sum(0))
    bright = pieces.radiance[:, 0] > 1.0
    assert bright.sum() == 1 and np.isclose(areas_of(pieces.corners[bright]), PARTS**-4)
    assert len(pieces.triangle) < 8


def test_each_light_has_its_own_budget():
    radiance = np.random.default_rng(2).random((2, PARTS**4, 3)) * [[[1.0]], [[1e-6]]]
    pieces = split(TRIANGLES, np.array([0, 1]), AREAS, radiance, 40)
    counts = [int((pieces.triangle == each).sum()) for each in TRIANGLES]
    assert all(34 < count <= 40 for count in counts)


def test_joined_pieces_keep_their_sides():
    whole = Pieces(np.array([3]), np.ones((1, 3)))
    joined = Pieces.joined([whole, Pieces(np.array([5]), np.ones((1, 3))).on_side(-1)])
    assert joined.triangle.tolist() == [3, 5] and joined.side.tolist() == [0, -1]
    assert np.array_equal(joined.corners, np.tile(np.eye(3), (2, 1, 1)))
    assert Pieces.joined([whole]) is whole
