# SPDX-License-Identifier: GPL-3.0-or-later
"""The point cloud: an instance has points in proportion to its area, and they stay where they are on it."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.passes.shadow_maps.sample_points import SamplePoints
from ism_addon.gpu.profile import Profile
from ism_addon.resources import POINT_CLOUD
from ism_addon.sampling.point_cloud import make_point_cloud
from ism_addon.sampling.points import triangle_areas
from tests.support import reference
from tests.support.small_scenes import (
    SMALL_SHADOW_MAPS,
    first_frame,
    light,
    make_scene,
    quad,
    random_triangles,
    transform,
)

ORIGIN = np.zeros(3)
SHEAR = np.array([[1.0, 0.7, 0.0], [0.0, 0.6, 0.3], [0.2, 0.0, 1.4]])
ROTATION = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def points_of_instances(scene, count: int) -> list[np.ndarray]:
    """The points of each instance, (n,3)."""
    areas = [
        triangle_areas(reference.world_triangles(scene, np.arange(len(scene.instances.mesh)) == k)).sum()
        for k in range(len(scene.instances.mesh))
    ]
    ends = np.rint(np.cumsum(areas) / np.sum(areas) * count).astype(int)
    return np.split(make_point_cloud(scene, ORIGIN, count).positions, ends[:-1])


def test_triangles_of_all_instances_have_points_by_area():
    meshes = [random_triangles(12, seed=1), quad((-1, -1, 0), (2, 0, 0), (0, 3, 0))]
    matrices = [
        transform(),
        transform(3.0 * ROTATION, (4.0, 0, 0)),
        transform(SHEAR, (0, 5.0, 0)),
        transform(np.diag([-1.0, 1, 1]), (0, 0, 3.0)),
    ]
    scene = make_scene(meshes, light(), matrices, [1, 0, 0, 1])
    triangles = reference.world_triangles(scene, np.ones(4, bool))
    cloud = make_point_cloud(scene, ORIGIN, 40_000)
    areas = triangle_areas(triangles)
    assert cloud.area == pytest.approx(areas.sum() / 40_000)
    a, b, c = np.moveaxis(triangles, 1, 0)
    normals = np.cross(b - a, c - a)
    hits = np.zeros(len(triangles))
    for points, facets in zip(np.array_split(cloud.positions, 40), np.array_split(cloud.normals, 40), strict=True):
        offsets = points[:, None] - a
        square = (normals**2).sum(1)
        height = np.abs((offsets * normals).sum(-1)) / np.sqrt(square)
        s = (np.cross(offsets, c - a) * normals).sum(-1) / square
        t = (np.cross(b - a, offsets) * normals).sum(-1) / square
        outside = np.maximum(np.maximum(-s, -t), s + t - 1.0)
        chosen = np.argmin(height + np.maximum(outside, 0.0), 1)
        rows = np.arange(len(points))
        assert height[rows, chosen].max() < 1e-5
        assert outside[rows, chosen].max() < 1e-4
        unit = normals[chosen] / np.sqrt(square[chosen])[:, None]
        assert np.abs((facets * unit).sum(1)) == pytest.approx(1.0, abs=1e-5)
        np.add.at(hits, chosen, 1)
    expected = areas / areas.sum() * 40_000
    assert (np.abs(hits - expected) < 5.0 * np.sqrt(expected) + 3.0).all()


def test_the_same_scene_gives_the_same_points():
    scene = make_scene([random_triangles()], light())
    one, two = (
        make_point_cloud(scene, ORIGIN, 3000),
        make_point_cloud(make_scene([random_triangles()], light()), ORIGIN, 3000),
    )
    assert np.array_equal(one.positions, two.positions)
    assert np.array_equal(one.normals, two.normals)


def test_an_object_that_does_not_move_keeps_its_points():
    """Another object moves, rotates and grows: its points move with it, the others stay."""
    meshes = [random_triangles(seed=1), random_triangles(seed=2)]
    still = make_scene(meshes, light(), [transform(), transform()])
    rotated = make_scene(meshes, light(), [transform(), transform(ROTATION, (3.0, 1.0, 0.0))])
    grown = make_scene(meshes, light(), [transform(), transform(2.0 * ROTATION, (3.0, 1.0, 0.0))])
    before, after, fewer = (points_of_instances(scene, 4000) for scene in (still, rotated, grown))
    assert np.array_equal(before[0], after[0])
    assert after[1] == pytest.approx(before[1] @ ROTATION.T + (3.0, 1.0, 0.0), abs=1e-5)
    assert len(fewer[0]) < len(before[0])
    assert np.array_equal(fewer[0], before[0][: len(fewer[0])])
    common = before[1] @ (2.0 * ROTATION).T + (3.0, 1.0, 0.0)
    assert fewer[1][: len(common)] == pytest.approx(common, abs=1e-5)


def test_a_larger_cloud_begins_with_the_points_of_a_smaller_one():
    scene = make_scene([random_triangles()], light())
    few, many = make_point_cloud(scene, ORIGIN, 1000), make_point_cloud(scene, ORIGIN, 5000)
    assert np.array_equal(many.positions[:1000], few.positions)


def test_instances_have_the_points_that_copies_of_the_mesh_would_have():
    matrices = [
        transform(),
        transform(2.0 * ROTATION, (5.0, 0, 0)),
        transform(SHEAR, (0, 5.0, 0)),
        transform(0.5 * np.eye(3), (0, 0, 5.0)),
    ]
    shared = make_point_cloud(make_scene([random_triangles()], light(), matrices, [0, 0, 0, 0]), ORIGIN, 4000)
    copies = make_point_cloud(make_scene([random_triangles()] * 4, light(), matrices), ORIGIN, 4000)
    assert np.array_equal(shared.positions, copies.positions)
    assert np.array_equal(shared.normals, copies.normals)


def test_only_instances_that_cast_shadows_have_points():
    scene = make_scene(
        [random_triangles(seed=1), random_triangles(seed=2)], light(), [transform(), transform(offset=(100.0, 0, 0))]
    )
    half = replace(scene, instances=replace(scene.instances, casts_shadow=np.array([True, False])))
    cloud = make_point_cloud(half, ORIGIN, 1000)
    assert len(cloud) == 1000
    assert cloud.positions[:, 0].max() < 50.0


def test_a_scene_without_area_has_no_points():
    assert len(make_point_cloud(make_scene([], light()), ORIGIN, 100)) == 0
    flat = make_scene([random_triangles()], light(), [transform(np.zeros((3, 3)))])
    assert len(make_point_cloud(flat, ORIGIN, 100)) == 0


def test_points_are_exact_far_from_the_worlds_origin():
    far = np.array([1e6, -1e6, 1e6])
    here = make_point_cloud(make_scene([random_triangles()], light()), ORIGIN, 1000)
    there = make_point_cloud(make_scene([random_triangles()], light(), [transform(offset=far)]), far, 1000)
    assert there.positions == pytest.approx(here.positions, abs=1e-6)


def test_the_pass_makes_at_least_as_many_points_as_a_map_takes(device):
    renderer, frame = first_frame(device, make_scene([random_triangles()], light()), SMALL_SHADOW_MAPS)
    renderer.graph.step(SamplePoints, frame, Profile())
    assert len(frame[POINT_CLOUD]) >= SMALL_SHADOW_MAPS.quality.map_points
