# SPDX-License-Identifier: GPL-3.0-or-later
"""The points that a light's maps see: about as many as asked for, and together the area that they stand for."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.passes.shadow_maps.point_cloud import make_point_cloud
from ism_addon.gpu.passes.shadow_maps.select_points import (
    MAP_POINT,
    SUBSETS_PER_LIGHT,
    select_subsets,
    selection_probabilities,
    solid_angles,
)
from ism_addon.resources import MAP_POINTS
from tests.scenes.small import SMALL
from tests.support.small_scenes import (
    SMALL_SHADOW_MAPS,
    draw,
    join_lights,
    light,
    look_at,
    make_scene,
    quad,
    random_triangles,
    with_quality,
)

ORIGIN = np.zeros(3)


#: The corners of a light, by its halves.
FOUR = [(1, 1), (1, -1), (-1, 1), (-1, -1)]


@pytest.mark.parametrize("spread", [0.1, 1.0, 3.0])
@pytest.mark.parametrize("part", [0.01, 0.3, 0.9])
def test_chances_sum_to_the_count(spread, part):
    weights = np.exp(spread * np.random.default_rng(0).normal(size=20_000)).astype(np.float32)
    count = int(part * len(weights))
    chance = selection_probabilities(weights, count)
    assert chance.min() >= 0.0
    assert chance.max() <= 1.0
    assert chance.sum() == pytest.approx(count, rel=0.01)
    free = chance < 1.0
    assert chance[free] / weights[free] == pytest.approx((chance[free] / weights[free]).mean(), rel=1e-4)


def test_chances_where_there_are_too_few_points_or_none_is_seen():
    assert (selection_probabilities(np.ones(10, np.float32), 100) == 1.0).all()
    assert not selection_probabilities(np.zeros(10, np.float32), 100).any()
    assert len(selection_probabilities(np.zeros(0, np.float32), 100)) == 0


@pytest.mark.parametrize("name", SMALL)
def test_a_subset_is_as_large_as_asked_for_and_stands_for_the_whole_area(name):
    scene, _ = SMALL[name](8, 8)
    cloud = make_point_cloud(scene, ORIGIN, 64_000)
    weights = solid_angles(cloud, scene.lights, 0, ORIGIN)
    seen = weights > 0.0
    subsets = select_subsets(cloud, weights, 4_000, 1.5)
    assert len(subsets) == SUBSETS_PER_LIGHT
    for points in subsets:
        assert len(points) == pytest.approx(4_000, rel=0.05)
        standing_for = np.pi * (points["radius"].astype(float) / 1.5) ** 2
        assert standing_for.sum() == pytest.approx(seen.sum() * cloud.area, rel=0.05)
        # Everywhere, not just as a whole: in each of eight slices across the scene.
        edges = np.quantile(cloud.positions[seen, 0], np.linspace(0.0, 1.0, 9))
        ours = np.histogram(points["position"][:, 0], edges, weights=standing_for)[0]
        theirs = np.histogram(cloud.positions[seen, 0], edges)[0] * cloud.area
        assert ours == pytest.approx(theirs, rel=0.15)


def test_discs_look_about_equally_large_from_the_light():
    """A floor of 40 m under a light at 1 m: without the weighting their sizes would differ by a factor of 400."""
    scene = make_scene(
        [quad((-20, -20, 0), (40, 0, 0), (0, 40, 0))],
        light(position=(0.0, 0.0, 1.0), axis_u=(0.1, 0, 0), axis_v=(0, -0.1, 0)),
    )
    cloud = make_point_cloud(scene, ORIGIN, 64_000)
    (points, *_) = select_subsets(cloud, solid_angles(cloud, scene.lights, 0, ORIGIN), 4_000, 1.0)
    angle = points["radius"] / np.linalg.norm(points["position"] - (0.0, 0.0, 1.0), axis=1)
    assert np.quantile(angle, 0.99) / np.quantile(angle, 0.01) < 10.0


def test_subsets_stay_while_something_else_changes():
    """The camera's anchor, or another light, leaves a light's subsets alone."""
    scene = make_scene([random_triangles()], light(position=(0.0, 0.0, 2.0)))
    cloud, moved = make_point_cloud(scene, ORIGIN, 8_000), make_point_cloud(scene, np.array([64.0, 0.0, 0.0]), 8_000)
    other = join_lights(scene.lights, light(position=(3.0, 0.0, 2.0)))
    first = select_subsets(cloud, solid_angles(cloud, scene.lights, 0, ORIGIN), 500, 1.0)
    second = select_subsets(cloud, solid_angles(cloud, other, 0, ORIGIN), 500, 1.0)
    third = select_subsets(moved, solid_angles(moved, scene.lights, 0, np.array([64.0, 0.0, 0.0])), 500, 1.0)
    for one, two, three in zip(first, second, third, strict=True):
        assert np.array_equal(one, two)
        here, there = (
            np.rint(1e3 * (p["position"] + shift)).astype(int) for p, shift in ((one, 0.0), (three, (64.0, 0.0, 0.0)))
        )
        same = set(map(tuple, here.tolist())) & set(map(tuple, there.tolist()))
        assert len(same) > 0.9 * len(one)


def test_each_lights_maps_see_its_own_subsets(device):
    one, other = light(position=(0.0, 0.0, 2.0)), light(position=(50.0, 0.0, 2.0), casts_shadow=False)
    floor = quad((-5, -5, 0), (60, 0, 0), (0, 10, 0))
    drawn = draw(
        device,
        make_scene([floor], join_lights(one, other)),
        look_at((3, -3, 2)),
        with_quality(SMALL_SHADOW_MAPS, map_points=500),
    )
    table, buffer = drawn.renderer.graph[MAP_POINTS].ranges, drawn.renderer.graph[MAP_POINTS].buffer
    points = np.frombuffer(buffer.read(), MAP_POINT)
    assert [len(row) for row in table] == [SUBSETS_PER_LIGHT, SUBSETS_PER_LIGHT]
    assert all(subset.count == 0 for subset in table[1])
    assert sum(subset.count for subset in table[0]) == len(points)
    assert drawn.profile.counts["map_points"] == max(subset.count for subset in table[0])


def test_behind_the_light_there_are_none():
    lights = light(position=(0.0, 0.0, 0.0))
    scene = make_scene([random_triangles(reach=3.0)], lights)
    cloud = make_point_cloud(scene, ORIGIN, 4_000)
    weights = solid_angles(cloud, lights, 0, ORIGIN)
    behind = cloud.positions[:, 2] > 2.0 * np.sqrt(cloud.area)
    assert behind.any()
    assert not weights[behind].any()
    assert weights[cloud.positions[:, 2] < 0.0].all()


@pytest.mark.parametrize("degrees", [20.0, 60.0, 120.0])
def test_none_where_a_spread_sends_no_light(degrees):
    """Of points that it can reach all may be chosen; of the others, but a margin about the cone, none."""
    lamp = light(position=(0.0, 0.0, 2.0), spread=np.radians(degrees))
    scene = make_scene([random_triangles(2000, reach=6.0)], lamp)
    cloud = make_point_cloud(scene, ORIGIN, 4_000)
    weights = solid_angles(cloud, lamp, 0, ORIGIN)
    corners = lamp.position[0] + 0.5 * np.array([u * lamp.axis_u[0] + v * lamp.axis_v[0] for u, v in FOUR])
    to = cloud.positions.astype(float) - corners[:, None]
    angle = np.degrees(np.arccos((to @ lamp.normal[0]) / np.linalg.norm(to, axis=2))).min(0)
    reached = angle < degrees / 2.0
    assert 10 < reached.sum() < len(cloud) - 10
    assert (weights[reached] > 0.0).all()
    size = np.linalg.norm(lamp.axis_u[0] + lamp.axis_v[0]) + 2.0 * np.sqrt(cloud.area)
    far = np.linalg.norm(to, axis=2).min(0) * np.sin(np.radians(np.clip(angle - degrees / 2.0, 0.0, 90.0))) > size
    assert far.sum() > 100
    assert not weights[far].any()


def test_behind_a_sheared_light_is_behind_the_plane_of_its_shape():
    """Its maps look away from that plane, wherever its object points."""
    lamp = light(position=(0.0, 0.0, 0.0))
    sheared = replace(lamp, normal=np.array([[0.8, 0.0, -0.6]]))
    cloud = make_point_cloud(make_scene([random_triangles(reach=3.0)], lamp), ORIGIN, 4_000)
    assert np.array_equal(solid_angles(cloud, sheared, 0, ORIGIN), solid_angles(cloud, lamp, 0, ORIGIN))


def test_a_light_that_casts_none_may_be_the_only_one(device):
    scene = make_scene([random_triangles()], replace(light(), casts_shadow=np.array([False])))
    assert draw(device, scene, look_at((3, -3, 2))).profile.rows["SelectPoints"].drawn == 0
