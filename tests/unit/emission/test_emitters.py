# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights of emissive meshes: which there are, and their triangles."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.color import REC709, luminance
from ism_addon.gpu.emission.baked_emission import SCENE_PIECES, SCENE_POINTS, BakedEmission, bakes_of, key_of
from ism_addon.gpu.emission.emissive_lights import MAX_EXACT_TRIANGLES
from ism_addon.gpu.emission.emitters import MAX_LIGHTS, EmissiveMeshes
from ism_addon.gpu.emission.pieces import Pieces
from ism_addon.gpu.lights import mixed_variant
from ism_addon.sampling.points import triangle_areas
from ism_addon.scene import Scene
from tests.scenes.parts.tables import instances_of, materials_of
from tests.scenes.small import mesh, sphere, subdivided_box
from tests.support.emission import textured, with_graph
from tests.support.small_scenes import light, make_scene, quad, transform

WARM = (2.0, 1.0, 0.5)
PANEL = quad((0, 0, 0), (1, 0, 0), (0, 1, 0))
BOX = subdivided_box((0, 0, 0), (1, 1, 1), 1)
BALL = sphere((0, 0, 0), 0.5, 16, 8)


def test_a_scene_that_emits_nothing_keeps_its_lights():
    scene = make_scene([PANEL], light())
    assert EmissiveMeshes().lights_of(scene) is scene.lights


def test_lights_follow_the_lamps():
    lights = EmissiveMeshes().lights_of(make_scene([PANEL, BALL], light(radiance=3.0), emission=WARM))
    assert lights.shape.tolist() == [0, 5, 5]
    assert np.allclose(lights.emission, [(3.0, 3.0, 3.0), WARM, WARM])
    assert lights.triangle_count[1] == 2 and lights.leaves[1] == 0
    assert lights.triangle_count[2] >= len(BALL.triangles) > MAX_EXACT_TRIANGLES and lights.leaves[2] > 0
    assert np.allclose(lights.projected_area[1:], [1.0, np.pi * 0.25], rtol=0.2)
    assert np.allclose(lights.position[1:], [(0.5, 0.5, 0.0), (0.0, 0.0, 0.0)], atol=1e-6)
    assert lights.one_sided[: lights.triangle_count[1]].tolist() == [False, False]


def test_instances_are_lights_of_their_own():
    matrices = np.array([transform(offset=(3.0 * k, 0.0, 0.0)) for k in range(3)])
    lights = EmissiveMeshes().lights_of(make_scene([BOX], matrices=matrices, mesh_ids=[0, 0, 0], emission=WARM))
    assert np.allclose(lights.position, [(3.0 * k + 0.5, 0.5, 0.5) for k in range(3)])
    assert lights.one_sided.all()


@pytest.mark.parametrize("mirrored", [False, True])
def test_closed_parts_face_outwards(mirrored):
    linear = np.diag([-1.0 if mirrored else 1.0, 1.0, 2.0])
    turned = mesh(BOX.positions, BOX.triangles[:, ::-1])
    for one in (BOX, turned):
        lights = EmissiveMeshes().lights_of(make_scene([one], matrices=np.array([transform(linear)]), emission=WARM))
        edges = lights.corners[:, 1:] - lights.corners[:, :1]
        normals, outwards = np.cross(edges[:, 0], edges[:, 1]), lights.corners.mean(1) - lights.position[0]
        assert (np.einsum("ni,ni->n", normals, outwards) > 0.0).all()
        assert np.allclose(lights.enclosure[0], [lights.corners.min((0, 1)), lights.corners.max((0, 1))])


@pytest.mark.parametrize(
    ("changes", "one_sided"),
    [
        ({}, True),
        ({"casts_shadow": [False]}, False),
        ({"blockers": [1], "groups": [2]}, True),
        ({"blockers": [1], "groups": [1]}, False),
    ],
    ids=["usual", "without shadow", "linked to itself", "linked to others"],
)
def test_a_part_that_does_not_hide_its_inner_side_emits_from_both(changes, one_sided):
    scene = replace(make_scene([BOX], emission=WARM), instances=instances_of([0], **changes))
    assert EmissiveMeshes().lights_of(scene).one_sided.all() == one_sided


def test_objects_without_diffuse_visibility_light_nothing():
    scene = replace(make_scene([BOX], emission=WARM), instances=instances_of([0], visible_diffuse=[False]))
    assert EmissiveMeshes().lights_of(scene) is scene.lights


def two_materials() -> Scene:
    """A box whose triangles have materials of two emissions, and a third without."""
    scene = make_scene([replace(BOX, materials=np.arange(12, dtype=np.uint32) % 4)])
    emission = [WARM, (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), WARM]
    return replace(scene, materials=materials_of(np.ones((4, 3)), emission=emission))


def test_parts_of_two_emissions_are_two_lights():
    lights = EmissiveMeshes().lights_of(two_materials())
    assert sorted(zip(lights.triangle_count.tolist(), lights.emission[:, 0].tolist(), strict=True)) == [(3, 1), (6, 2)]
    assert lights.one_sided.all(), "the box is closed, whatever its triangles emit"


def test_links_are_the_instances():
    scene = replace(
        make_scene([PANEL, PANEL], emission=WARM), instances=instances_of([0, 1], receivers=[3, -1], blockers=[-1, 4])
    )
    lights = EmissiveMeshes().lights_of(scene)
    assert lights.receivers.tolist() == [3, -1] and lights.blockers.tolist() == [-1, 4]


def test_many_lights_are_joined_with_their_neighbours():
    side = 30
    places = np.stack(np.meshgrid(np.arange(side), np.arange(side)), -1).reshape(-1, 2) * 2.0
    matrices = np.array([transform(offset=(x, y, 0.0)) for x, y in places])
    lights = EmissiveMeshes().lights_of(make_scene([BOX], matrices=matrices, mesh_ids=[0] * side**2, emission=WARM))
    assert side**2 / 8 <= len(lights.shape) <= MAX_LIGHTS
    assert triangle_areas(lights.corners).sum() == pytest.approx(6.0 * side**2)
    assert lights.radius.max() < 8.0, "neighbours"
    assert np.count_nonzero(np.linalg.norm(lights.corners, axis=2).any(1)) >= 12 * side**2


@pytest.mark.parametrize("closed", [True, False])
def test_no_direction_sees_more_than_the_projected_area(closed):
    shape = sphere((0, 0, 0), 1.0, 24, 12)
    shape = mesh(shape.positions * np.array([1.0, 0.5, 0.1]), shape.triangles if closed else shape.triangles[40:])
    lights = EmissiveMeshes().lights_of(make_scene([shape], emission=WARM))
    edges = lights.corners[:, 1:] - lights.corners[:, :1]
    directions = np.random.default_rng(1).normal(size=(1000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    facing = np.cross(edges[:, 0], edges[:, 1]) @ directions.T / 2.0
    seen = (np.maximum(facing, 0.0) if closed else np.abs(facing)).sum(0)
    assert lights.one_sided.all() == closed
    assert 0.8 * lights.projected_area[0] < seen.max() <= lights.projected_area[0]


def test_lights_are_kept_until_their_meshes_change():
    meshes, scene = EmissiveMeshes(), make_scene([PANEL, BALL], light(), emission=WARM)
    lights = meshes.lights_of(scene)
    assert meshes.lights_of(scene) is lights
    assert meshes.lights_of(replace(scene, world=replace(scene.world))) is lights
    other_lamps = meshes.lights_of(replace(scene, lights=light(position=(9.0, 0.0, 0.0))))
    assert other_lamps is not lights and other_lamps.position[0, 0] == 9.0
    assert np.shares_memory(other_lamps.corners, meshes.own.corners), "no light BVH is built again"
    matrices = np.array([transform(), transform(offset=(0.0, 0.0, 1.0))])
    moved = meshes.lights_of(replace(scene, instances=replace(scene.instances, world_from_object=matrices)))
    assert np.allclose(moved.position[2], (0.0, 0.0, 1.0), atol=1e-6)


def test_triangles_without_area_are_left_out():
    flat = mesh(
        np.concatenate([BOX.positions, np.zeros((3, 3))]),
        np.concatenate([BOX.triangles, len(BOX.positions) + np.arange(3)[None]]),
    )
    lights = EmissiveMeshes().lights_of(make_scene([flat], emission=WARM))
    assert len(lights.shape) == 1 and lights.triangle_count.tolist() == [12]
    nothing = make_scene([mesh(np.zeros((3, 3)), np.array([[0, 1, 2]]))], emission=WARM)
    assert EmissiveMeshes().lights_of(nothing) is nothing.lights


@pytest.mark.parametrize("shape", [BOX, BALL], ids=["box", "ball"])
def test_triangles_are_brighter_or_darker_than_their_light(shape):
    radiance = np.random.default_rng(3).random((len(shape.triangles), 3)) ** 3
    lights, areas = textured(shape, radiance), triangle_areas(shape.positions[shape.triangles])
    weights = luminance(REC709)
    assert lights.varies.tolist() == [True]
    assert np.allclose(lights.emission, areas @ radiance / areas.sum())
    assert np.isclose(lights.brightest[0], (radiance @ weights).max() / (lights.emission[0] @ weights))
    exist = np.linalg.norm(lights.corners, axis=2).any(1)
    absolute = lights.emission[0] * lights.colors[exist, :3] * lights.colors[exist, 3:]
    assert np.allclose(np.sort(absolute, axis=0), np.sort(radiance, axis=0))
    assert np.allclose((lights.emission[0] * lights.colors[:, :3]) @ weights, lights.emission[0] @ weights)


def test_without_a_texture_there_are_no_colors():
    """Neither without graphs nor if a graph's radiance is even."""
    plain = EmissiveMeshes().lights_of(make_scene([BALL], emission=WARM))
    graph = textured(BALL, np.tile(np.float32(WARM), (len(BALL.triangles), 1)))
    assert not len(graph.colors) and not graph.varies.any() and graph.brightest.tolist() == [1.0]
    assert graph.equals(plain)
    assert mixed_variant(graph)["mesh_colors"] == 0, "shaders are the same, too"
    dark = np.ones((len(BALL.triangles), 3)) * (np.arange(len(BALL.triangles)) % 2)[:, None]
    assert mixed_variant(textured(BALL, dark))["mesh_colors"] == 1


def test_pieces_of_one_side_emit_from_it_alone():
    scene = with_graph(
        make_scene([PANEL], matrices=np.array([transform(), transform(np.diag([-1.0, 1.0, 1.0]))]), mesh_ids=[0, 0])
    )
    for side in (1, -1):
        pieces = Pieces(np.arange(2), np.ones((2, 3))).on_side(side)
        lights = EmissiveMeshes().lights_of(scene, BakedEmission(key_of(scene), None, dict.fromkeys(range(2), pieces)))
        edges = lights.corners[:, 1:] - lights.corners[:, :1]
        height = np.cross(edges[:, 0], edges[:, 1])[:, 2]
        assert lights.one_sided.all() and (np.sign(height) == side).all(), "a mirrored instance is not turned around"


def test_emission_of_another_scene_is_not_used():
    scene = with_graph(make_scene([PANEL], emission=WARM))
    pieces = Pieces(np.array([0]), np.full((1, 3), 7.0))
    meshes, baked = EmissiveMeshes(), BakedEmission(key_of(scene), None, {0: pieces})
    assert np.allclose(meshes.lights_of(scene, baked).emission, 7.0)
    other = replace(scene, materials=replace(scene.materials, constants=2.0 * scene.materials.constants))
    assert np.allclose(meshes.lights_of(other, baked).emission, WARM)
    moved = replace(scene, lights=light())
    assert np.allclose(meshes.lights_of(moved, baked).emission[1], 7.0), "lamps are not part of it"


def test_many_textured_lights_share_a_budget():
    count = 200
    matrices = np.array([transform(offset=(3.0 * k, 0.0, 0.0)) for k in range(count)])
    (bake,) = bakes_of(with_graph(make_scene([PANEL], matrices=matrices, mesh_ids=[0] * count)))
    assert bake.max_pieces * count <= SCENE_PIECES and bake.points * count <= SCENE_POINTS
