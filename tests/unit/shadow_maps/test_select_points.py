# SPDX-License-Identifier: GPL-3.0-or-later
"""The points selected for a light's maps: about as many as requested, together representing the whole area."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.passes.shadow_maps.select_points import (
    MAP_POINT,
    SUBSETS_PER_LIGHT,
    select_subsets,
    selection_probabilities,
    solid_angles,
)
from ism_addon.resources import MAP_POINTS
from ism_addon.sampling.point_cloud import make_point_cloud
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


#: The corners of a light, as multiples of its half axes.
CORNERS = [(1, 1), (1, -1), (-1, 1), (-1, -1)]


@pytest.mark.parametrize("spread", [0.1, 1.0, 3.0])
@pytest.mark.parametrize("fraction", [0.01, 0.3, 0.9])
def test_probabilities_sum_to_the_count(spread, fraction):
    weights = np.exp(spread * np.random.default_rng(0).normal(size=20_000)).astype(np.float32)
    count = int(fraction * len(weights))
    probability = selection_probabilities(weights, count)
    assert probability.min() >= 0.0
    assert probability.max() <= 1.0
    assert probability.sum() == pytest.approx(count, rel=0.01)
    uncertain = probability < 1.0
    ratio = probability[uncertain] / weights[uncertain]
    assert ratio == pytest.approx(ratio.mean(), rel=1e-4)


def test_probabilities_with_too_few_points_or_none():
    assert (selection_probabilities(np.ones(10, np.float32), 100) == 1.0).all()
    assert not selection_probabilities(np.zeros(10, np.float32), 100).any()
    assert len(selection_probabilities(np.zeros(0, np.float32), 100)) == 0


@pytest.mark.parametrize("name", SMALL)
def test_a_subset_has_the_requested_size_and_represents_the_whole_area(name):
    scene, _ = SMALL[name](8, 8)
    cloud = make_point_cloud(scene, ORIGIN, 64_000)
    weights = solid_angles(cloud, scene.lights, 0, ORIGIN)
    lit = weights > 0.0
    subsets = select_subsets(cloud, weights, 4_000, 1.5)
    assert len(subsets) == SUBSETS_PER_LIGHT
    for points in subsets:
        assert len(points) == pytest.approx(4_000, rel=0.05)
        areas = np.pi * (points["radius"].astype(float) / 1.5) ** 2
        assert areas.sum() == pytest.approx(lit.sum() * cloud.area, rel=0.05)
        # Not only in total, but also in each of eight slices across the scene.
        edges = np.quantile(cloud.positions[lit, 0], np.linspace(0.0, 1.0, 9))
        ours = np.histogram(points["position"][:, 0], edges, weights=areas)[0]
        expected = np.histogram(cloud.positions[lit, 0], edges)[0] * cloud.area
        assert ours == pytest.approx(expected, rel=0.15)


def test_discs_have_similar_angular_sizes_from_the_light():
    """A floor of 40 m under a light at 1 m: without the weighting their sizes would differ by a factor of 400."""
    scene = make_scene(
        [quad((-20, -20, 0), (40, 0, 0), (0, 40, 0))],
        light(position=(0.0, 0.0, 1.0), axis_u=(0.1, 0, 0), axis_v=(0, -0.1, 0)),
    )
    cloud = make_point_cloud(scene, ORIGIN, 64_000)
    (points, *_) = select_subsets(cloud, solid_angles(cloud, scene.lights, 0, ORIGIN), 4_000, 1.0)
    angles = points["radius"] / np.linalg.norm(points["position"] - (0.0, 0.0, 1.0), axis=1)
    assert np.quantile(angles, 0.99) / np.quantile(angles, 0.01) < 10.0


def test_subsets_do_not_depend_on_the_anchor_or_other_lights():
    """A light's subsets stay the same when the camera's anchor or another light changes."""
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
        common = set(map(tuple, here.tolist())) & set(map(tuple, there.tolist()))
        assert len(common) > 0.9 * len(one)


def test_each_lights_maps_take_its_own_subsets(device):
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


def test_no_points_are_selected_behind_the_light():
    lights = light(position=(0.0, 0.0, 0.0))
    scene = make_scene([random_triangles(extent=3.0)], lights)
    cloud = make_point_cloud(scene, ORIGIN, 4_000)
    weights = solid_angles(cloud, lights, 0, ORIGIN)
    behind = cloud.positions[:, 2] > 2.0 * np.sqrt(cloud.area)
    assert behind.any()
    assert not weights[behind].any()
    assert weights[cloud.positions[:, 2] < 0.0].all()


@pytest.mark.parametrize("degrees", [20.0, 60.0, 120.0])
def test_no_points_are_selected_outside_a_spread(degrees):
    """All points within the cone may be selected, and none outside it, except in a margin around it."""
    one = light(position=(0.0, 0.0, 2.0), spread=np.radians(degrees))
    scene = make_scene([random_triangles(2000, extent=6.0)], one)
    cloud = make_point_cloud(scene, ORIGIN, 4_000)
    weights = solid_angles(cloud, one, 0, ORIGIN)
    corners = one.position[0] + 0.5 * np.array([u * one.axis_u[0] + v * one.axis_v[0] for u, v in CORNERS])
    to = cloud.positions.astype(float) - corners[:, None]
    angle = np.degrees(np.arccos((to @ one.normal[0]) / np.linalg.norm(to, axis=2))).min(0)
    lit = angle < degrees / 2.0
    assert 10 < lit.sum() < len(cloud) - 10
    assert (weights[lit] > 0.0).all()
    size = np.linalg.norm(one.axis_u[0] + one.axis_v[0]) + 2.0 * np.sqrt(cloud.area)
    far = np.linalg.norm(to, axis=2).min(0) * np.sin(np.radians(np.clip(angle - degrees / 2.0, 0.0, 90.0))) > size
    assert far.sum() > 100
    assert not weights[far].any()


def test_points_behind_a_sheared_light_are_those_behind_the_plane_of_its_shape():
    """Its maps face away from that plane, whatever the direction of its object's axis."""
    one = light(position=(0.0, 0.0, 0.0))
    sheared = replace(one, normal=np.array([[0.8, 0.0, -0.6]]))
    cloud = make_point_cloud(make_scene([random_triangles(extent=3.0)], one), ORIGIN, 4_000)
    assert np.array_equal(solid_angles(cloud, sheared, 0, ORIGIN), solid_angles(cloud, one, 0, ORIGIN))


def test_no_points_are_selected_if_the_only_light_casts_no_shadow(device):
    scene = make_scene([random_triangles()], replace(light(), casts_shadow=np.array([False])))
    assert draw(device, scene, look_at((3, -3, 2))).profile.rows["SelectPoints"].drawn == 0
