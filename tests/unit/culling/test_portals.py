# SPDX-License-Identifier: GPL-3.0-or-later
"""Portals: rectangles that fit the openings of rooms, however these stand, and none where they would not pay."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.culling.portal_geometry import Rays, Rectangle
from ism_addon.gpu.culling.portals import MIN_RAYS, Portals, find_portals, turned

SIZE = np.array([5.0, 4.0, 2.6])  # of a room that begins at the origin, m
#: Openings: the axis and end of their wall, and their low and high corners along the other axes.
WINDOW = (0, 0, (1.0, 0.9), (2.4, 2.1))
DOOR = (1, 1, (3.2, 0.0), (4.3, 2.1))
NARROW = (0, 1, (3.0, 0.9), (3.4, 2.1))  # opposite the window


def rays_in_room(openings, count: int = 10_000, turn: float = 0.0, offset=(0.0, 0.0, 0.0), seed: int = 0) -> Rays:
    """Cosine-distributed rays from the walls, the floor and the ceiling of a room with openings."""
    random = np.random.default_rng(seed)
    axis, end = random.integers(3, size=count), random.integers(2, size=count)
    rows = np.arange(count)
    origins = random.random((count, 3)) * SIZE
    origins[rows, axis] = end * SIZE[axis]
    radius, angle = np.sqrt(random.random(count)), 2.0 * np.pi * random.random(count)
    directions = np.zeros((count, 3))
    directions[rows, axis] = np.sqrt(1.0 - radius**2) * (1 - 2 * end)
    directions[rows, (axis + 1) % 3], directions[rows, (axis + 2) % 3] = radius * np.cos(angle), radius * np.sin(angle)
    with np.errstate(divide="ignore", invalid="ignore"):
        distances = np.where(directions == 0.0, np.inf, (np.where(directions > 0.0, SIZE, 0.0) - origins) / directions)
    distances[rows, axis] = np.where(distances[rows, axis] > 0.0, distances[rows, axis], np.inf)
    wall, points = distances.argmin(1), origins + distances.min(1)[:, None] * directions
    unoccluded = np.zeros(count, bool)
    for own_axis, own_end, low, high in openings:
        others = [k for k in range(3) if k != own_axis]
        inside = (points[:, others] > low).all(1) & (points[:, others] < high).all(1)
        unoccluded |= (wall == own_axis) & ((directions[rows, own_axis] > 0.0) == own_end) & inside
    axes = turned(turn)
    return Rays(origins @ axes + offset, directions @ axes, unoccluded, np.ones(count))


def area(rectangle: Rectangle) -> float:
    return float(np.prod(np.linalg.norm(rectangle.sides, axis=1)))


@pytest.mark.parametrize("turn", [0.0, 0.4, 1.2])
@pytest.mark.parametrize("openings", [(WINDOW,), (WINDOW, DOOR), (WINDOW, NARROW)])
def test_portals_fit_openings(openings, turn):
    """They are as large as the openings, within a tenth, and nearly all light comes through them."""
    rays = rays_in_room(openings, turn=turn, offset=(100.0, -50.0, 3.0))
    portals = find_portals(rays)
    assert portals is not None and len(portals.rectangles) == len(openings)
    sizes = sorted(np.prod(np.subtract(high, low)) for _, _, low, high in openings)
    assert sorted(map(area, portals.rectangles)) == pytest.approx(sizes, rel=0.1)
    assert portals.missed < 0.02
    crossed = np.any([each.crossed_by(rays) for each in portals.rectangles], axis=0)
    assert crossed[rays.unoccluded].mean() > 0.98
    assert rays.unoccluded[crossed].mean() == pytest.approx(portals.arriving, abs=0.02) and portals.arriving > 0.9


def test_an_opening_is_found_whole_where_only_a_part_of_the_room_is_visible():
    """Rays through a part of the window leave the box around what is visible by another face than those beside it."""
    rays = rays_in_room((WINDOW,), count=40_000)
    rays = rays[rays.origins[:, 1] > 1.4]
    portals = find_portals(rays)
    assert portals is not None and len(portals.rectangles) == 1
    assert area(portals.rectangles[0]) == pytest.approx(1.4 * 1.2, rel=0.1) and portals.missed < 0.02


def test_normals_point_into_the_room():
    for each in find_portals(rays_in_room((WINDOW, DOOR))).rectangles:
        assert (SIZE / 2.0 - each.centre) @ each.normal > 0.0


def test_there_are_none_outdoors_nor_in_the_dark():
    rays = rays_in_room((WINDOW,))
    for unoccluded in (np.ones(len(rays), bool), np.zeros(len(rays), bool), np.arange(len(rays)) < MIN_RAYS - 1):
        assert find_portals(replace(rays, unoccluded=unoccluded)) is None
    assert find_portals(rays[:0]) is None


def test_there_are_none_where_light_comes_through_holes_everywhere():
    """As through leaves: rectangles would not leave out directions that are occluded."""
    rays = rays_in_room(())
    unoccluded = np.random.default_rng(1).random(len(rays)) < 0.2
    assert find_portals(replace(rays, unoccluded=unoccluded)) is None


def test_there_are_none_where_most_light_comes_from_few_directions():
    """Samples that are evenly distributed over the window would seldom find them."""
    rays = rays_in_room((WINDOW,))
    is_bright = np.random.default_rng(2).random(len(rays)) < 0.5
    uneven = replace(rays, radiance=np.where(is_bright, 1000.0, 1.0))
    assert Rays.unevenness(uneven, rays.unoccluded) == pytest.approx(250.0, rel=0.1)
    assert find_portals(rays) is not None and find_portals(uneven) is None


@pytest.mark.parametrize(("crossed", "missed"), [(0.02, 0.01), (0.1, 0.1), (0.3, 0.02)])
def test_the_probability_has_the_least_variance(crossed, missed):
    portals = Portals((), crossed, 0.5, missed)
    probabilities = np.linspace(0.01, 0.99, 197)
    second_moments = (1.0 - missed) * crossed / probabilities + missed / (1.0 - probabilities)
    best = probabilities[second_moments.argmin()]
    assert portals.probability == pytest.approx(min(best, 0.9), abs=0.01)
    if best < 0.9:
        assert 1.0 / portals.gain == pytest.approx(second_moments.min(), rel=0.01)


@pytest.mark.parametrize(("crossed", "missed"), [(0.02, 0.01), (0.1, 0.1), (0.3, 0.02)])
def test_the_importance_beside_portals_has_the_least_variance(crossed, missed):
    """Of two directions with equal estimates, one of them through a portal, one is chosen by importance."""
    unoccluded_through, unoccluded_beside = (1.0 - missed) / crossed, missed / (1.0 - crossed)  # relative
    importances = np.linspace(1e-3, 1.0, 1000)
    second_moments = (unoccluded_through + unoccluded_beside / importances) * (1.0 + importances)
    best = importances[second_moments.argmin()]
    assert Portals((), crossed, 0.5, missed).importance_beside == pytest.approx(best, abs=2e-3)


@pytest.mark.parametrize(("crossed", "missed"), [(0.0, 0.5), (1.0, 0.1)])
def test_that_importance_is_a_number_at_the_limits(crossed, missed):
    assert 0.0 <= Portals((), crossed, 0.5, missed).importance_beside <= 1.0
