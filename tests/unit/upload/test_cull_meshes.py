# SPDX-License-Identifier: GPL-3.0-or-later
"""Mesh culling: only meshes that are in the picture or may occlude its lights are uploaded."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.resources import MESH_BUFFERS, RESIDENT_MESHES
from ism_addon.scene import LightShape
from ism_addon.settings import Method
from tests.support.rays import reference_occlusion
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    SMALL_SHADOW_MAPS,
    draw,
    join_lights,
    light,
    look_at,
    make_scene,
    quad,
    random_triangles,
    transform,
    view_from_above,
)

#: Viewed from above, lit from 2 m above its centre.
FLOOR = quad((-2.0, -2.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0))


def resident_meshes(drawn) -> tuple[int, ...]:
    """Indices of the meshes that the picture needed."""
    return drawn.renderer.graph[RESIDENT_MESHES].indices


def with_mesh_at(position, lights=None, size: float = 0.2):
    """The floor, and random triangles at a position: enough of them that culling is worth its cost."""
    matrices = np.stack([transform(), transform(size * np.eye(3), position)])
    return make_scene([FLOOR, random_triangles(200)], light() if lights is None else lights, matrices)


VIEW = view_from_above(1.0)
SUN = light(LightShape.SUN, spread=0.0)
ABOVE, BESIDE = (0.0, 0.0, 1.0), (1.3, 0.0, 0.3)


@pytest.mark.parametrize(
    "position, lights, needed",
    [
        (ABOVE, light(), True),
        (BESIDE, light(), False),
        (BESIDE, light(position=(4.0, 0.0, 1.0)), True),
        ((0.0, 0.0, -2.0), light(), True),  # its bounding box is in the picture
        ((3.0, 0.0, 5.0), light(), False),  # beyond the light
        ((3.0, 0.0, 5.0), light(position=(6.0, 0.0, 9.0)), True),
        ((2.0, 0.0, 1.0), light(position=(4.0, 0.0, 1.9), axis_v=(0.0, 1.0, 0.0)), False),  # the light shines upwards
        (BESIDE, light(position=(4.0, 0.0, 1.0), casts_shadow=False), False),
        (BESIDE, light(position=(4.0, 0.0, 1.0), radiance=0.0), False),
        (BESIDE, light(position=(4.0, 0.0, 1.0), blockers=3), False),
        (BESIDE, join_lights(light(), light(position=(4.0, 0.0, 1.0))), True),
        (ABOVE, SUN, True),
        (BESIDE, SUN, False),
        (BESIDE, light(LightShape.SUN, spread=2.0), True),
        ((0.0, 3e4, 4e4), light(LightShape.SUN, spread=0.0, axis_v=(0.0, -0.8, 0.6)), True),
        ((0.0, 3e4, -4e4), light(LightShape.SUN, spread=0.0, axis_v=(0.0, -0.8, 0.6)), False),
    ],
)
def test_an_off_screen_mesh_is_needed_if_it_may_occlude_a_light(device, position, lights, needed):
    assert resident_meshes(draw(device, with_mesh_at(position, lights), VIEW)) == ((0, 1) if needed else (0,))


def test_a_mesh_that_casts_no_shadow_is_needed_in_the_picture_only(device):
    lights = light(position=(4.0, 0.0, 1.0))
    for position, expected in ((BESIDE, (0,)), (ABOVE, (0, 1))):
        scene = with_mesh_at(position, lights)
        scene = replace(scene, instances=replace(scene.instances, casts_shadow=np.array([True, False])))
        assert resident_meshes(draw(device, scene, VIEW)) == expected


def test_a_mesh_that_is_invisible_to_the_camera_may_occlude(device):
    for position, expected in ((BESIDE, (0,)), (ABOVE, (0, 1))):
        scene = with_mesh_at(position)
        scene = replace(scene, instances=replace(scene.instances, visible=np.array([True, False])))
        assert resident_meshes(draw(device, scene, VIEW)) == expected


def test_shadow_maps_need_only_meshes_in_the_picture(device):
    """They are made from points, for which no mesh is uploaded."""
    scene = with_mesh_at(BESIDE, light(position=(4.0, 0.0, 1.0)))
    assert resident_meshes(draw(device, scene, VIEW, SMALL_SHADOW_MAPS)) == (0,)
    assert SMALL_SHADOW_MAPS.shadow.method == Method.SHADOW_MAPS


def test_without_shortcuts_all_meshes_are_needed(device):
    assert resident_meshes(draw(device, with_mesh_at(BESIDE), VIEW, replace(SMALL_SETTINGS, shortcuts=False))) == (0, 1)


def test_a_picture_of_the_background_needs_no_mesh(device):
    away = look_at((0.0, 0.0, 50.0), (1.0, 0.0, 90.0))
    drawn = draw(device, with_mesh_at(ABOVE), away)
    assert resident_meshes(drawn) == ()
    assert not drawn.color[..., :3].any()


def test_meshes_with_few_triangles_are_not_culled(device):
    scene = with_mesh_at(BESIDE)
    few = replace(scene, meshes=(FLOOR, random_triangles(3)))
    assert resident_meshes(draw(device, few, VIEW)) == (0, 1)


def test_a_mesh_is_uploaded_when_it_comes_into_the_picture_and_stays(device):
    scene, elsewhere = (
        with_mesh_at((1.3, 0.0, 0.3)),
        replace(VIEW, view_from_world=transform(offset=(-1.3, 0.0, -10.0))),
    )
    first = draw(device, scene, VIEW)
    assert first.profile.counts["bytes_uploaded"] < 44 * 200
    second = draw(device, scene, elsewhere, renderer=first.renderer)
    assert resident_meshes(second) == (0, 1)
    assert second.profile.counts["bytes_uploaded"] >= 44 * 200
    assert np.array_equal(second.color, draw(device, scene, elsewhere).color)
    third = draw(device, scene, VIEW, renderer=first.renderer)
    assert resident_meshes(third) == (0, 1)
    assert third.profile.counts["bytes_uploaded"] == 0
    assert not third.profile.rows["BuildBLAS"].drawn
    assert np.array_equal(third.color, first.color)


def test_renderers_that_share_meshes_need_different_ones(device):
    """Each finds the meshes that the other has uploaded, in the order in which it did."""
    scene = with_mesh_at((1.3, 0.0, 0.3))
    elsewhere = replace(VIEW, view_from_world=transform(offset=(-1.3, 0.0, -10.0)))
    one = draw(device, scene, VIEW)
    other = draw(device, scene, elsewhere)
    assert one.renderer.graph[MESH_BUFFERS] is other.renderer.graph[MESH_BUFFERS]
    assert resident_meshes(one) == (0,)
    again = draw(device, scene, elsewhere, renderer=one.renderer)
    assert np.array_equal(again.color, other.color)


@pytest.mark.parametrize("seed", range(6))
def test_culled_meshes_occlude_no_light_of_visible_surfaces(device, seed):
    """Rays from visible surfaces to the lights hit no culled mesh, in float64."""
    random = np.random.default_rng(seed)
    count = 60
    matrices = np.stack(
        [transform(), *(transform(0.3 * random.normal(size=(3, 3)), 5.0 * random.normal(size=3)) for _ in range(count))]
    )
    lights = join_lights(
        *(
            light(position=4.0 * random.normal(size=3), axis_u=random.normal(size=3), axis_v=random.normal(size=3))
            for _ in range(2)
        )
    )
    scene = make_scene([FLOOR, *(random_triangles(100, seed=k) for k in range(count))], lights, matrices)
    view = look_at(3.0 * random.normal(size=3) + (0.0, 0.0, 4.0)) if seed % 2 else view_from_above(2.0)
    drawn = draw(device, scene, view)
    culled = np.setdiff1d(np.arange(count + 1), resident_meshes(drawn))
    assert len(culled) > 5
    position = drawn.target("position")
    visible = position[position[..., 3] > 0.0][:, :3] + drawn.renderer.last[0].anchor
    starts = visible[random.integers(len(visible), size=400)]
    index, uv = random.integers(2, size=400), random.uniform(-0.5, 0.5, (2, 400, 1))
    ends = lights.position[index] + uv[0] * lights.axis_u[index] + uv[1] * lights.axis_v[index]
    lit = ((starts - lights.position[index]) * np.cross(lights.axis_u, lights.axis_v)[index]).sum(1) > 0.0
    instances = replace(scene.instances, casts_shadow=np.isin(scene.instances.mesh, culled))
    occluded, _ = reference_occlusion(replace(scene, instances=instances), starts[lit], ends[lit])
    assert not occluded.any()
