# SPDX-License-Identifier: GPL-3.0-or-later
"""Which meshes a picture needs: those in it and in the way of its light; no others are uploaded."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.resources import MESH_BUFFERS, RESIDENT_MESHES
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

#: Looked at from above, lit from 2 m above its middle.
FLOOR = quad((-2.0, -2.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0))


def wanted(drawn) -> tuple[int, ...]:
    return drawn.renderer.graph[RESIDENT_MESHES].indices


def with_one_at(place, lights=None, size: float = 0.2):
    """The floor, and rubble somewhere: its triangles are so many that to look is worth while."""
    matrices = np.stack([transform(), transform(size * np.eye(3), place)])
    return make_scene([FLOOR, random_triangles(200)], light() if lights is None else lights, matrices)


VIEW = view_from_above(1.0)
ABOVE, BESIDE = (0.0, 0.0, 1.0), (1.3, 0.0, 0.3)


@pytest.mark.parametrize(
    "place, lights, needed",
    [
        (ABOVE, light(), True),
        (BESIDE, light(), False),
        (BESIDE, light(position=(4.0, 0.0, 1.0)), True),
        ((0.0, 0.0, -2.0), light(), True),  # in the picture, as far as boxes can tell
        ((3.0, 0.0, 5.0), light(), False),  # beyond the light
        ((3.0, 0.0, 5.0), light(position=(6.0, 0.0, 9.0)), True),
        ((2.0, 0.0, 1.0), light(position=(4.0, 0.0, 1.9), axis_v=(0.0, 1.0, 0.0)), False),  # the light shines upwards
        (BESIDE, light(position=(4.0, 0.0, 1.0), casts_shadow=False), False),
        (BESIDE, light(position=(4.0, 0.0, 1.0), radiance=0.0), False),
        (BESIDE, light(position=(4.0, 0.0, 1.0), blockers=3), False),
        (BESIDE, join_lights(light(), light(position=(4.0, 0.0, 1.0))), True),
    ],
)
def test_off_screen_a_mesh_is_wanted_if_it_is_in_a_lights_way(device, place, lights, needed):
    assert wanted(draw(device, with_one_at(place, lights), VIEW)) == ((0, 1) if needed else (0,))


def test_what_casts_no_shadow_is_wanted_in_the_picture_alone(device):
    lights = light(position=(4.0, 0.0, 1.0))
    for place, expected in ((BESIDE, (0,)), (ABOVE, (0, 1))):
        scene = with_one_at(place, lights)
        scene = replace(scene, instances=replace(scene.instances, casts_shadow=np.array([True, False])))
        assert wanted(draw(device, scene, VIEW)) == expected


def test_what_the_camera_does_not_see_may_be_in_the_way(device):
    for place, expected in ((BESIDE, (0,)), (ABOVE, (0, 1))):
        scene = with_one_at(place)
        scene = replace(scene, instances=replace(scene.instances, visible=np.array([True, False])))
        assert wanted(draw(device, scene, VIEW)) == expected


def test_shadow_maps_want_only_what_is_in_the_picture(device):
    """They see points, which need no upload of meshes."""
    scene = with_one_at(BESIDE, light(position=(4.0, 0.0, 1.0)))
    assert wanted(draw(device, scene, VIEW, SMALL_SHADOW_MAPS)) == (0,)
    assert SMALL_SHADOW_MAPS.shadow.method == Method.SHADOW_MAPS


def test_without_skipping_all_are_wanted(device):
    assert wanted(draw(device, with_one_at(BESIDE), VIEW, replace(SMALL_SETTINGS, shortcuts=False))) == (0, 1)


def test_a_picture_of_nothing_wants_nothing(device):
    away = look_at((0.0, 0.0, 50.0), (1.0, 0.0, 90.0))
    drawn = draw(device, with_one_at(ABOVE), away)
    assert wanted(drawn) == ()
    assert not drawn.color[..., :3].any()


def test_few_triangles_are_uploaded_sooner_than_looked_at(device):
    scene = with_one_at(BESIDE)
    few = replace(scene, meshes=(FLOOR, random_triangles(3)))
    assert wanted(draw(device, few, VIEW)) == (0, 1)


def test_what_comes_into_the_picture_is_uploaded_then_and_stays(device):
    scene, elsewhere = with_one_at((1.3, 0.0, 0.3)), replace(VIEW, view_from_world=transform(offset=(-1.3, 0.0, -10.0)))
    first = draw(device, scene, VIEW)
    assert first.profile.counts["bytes_uploaded"] < 44 * 200
    second = draw(device, scene, elsewhere, renderer=first.renderer)
    assert wanted(second) == (0, 1)
    assert second.profile.counts["bytes_uploaded"] >= 44 * 200
    assert np.array_equal(second.color, draw(device, scene, elsewhere).color)
    third = draw(device, scene, VIEW, renderer=first.renderer)
    assert wanted(third) == (0, 1)
    assert third.profile.counts["bytes_uploaded"] == 0
    assert not third.profile.rows["BuildBLAS"].drawn
    assert np.array_equal(third.color, first.color)


def test_renderers_that_share_meshes_want_their_own(device):
    """What one has uploaded, in its order, the other finds."""
    scene = with_one_at((1.3, 0.0, 0.3))
    elsewhere = replace(VIEW, view_from_world=transform(offset=(-1.3, 0.0, -10.0)))
    one = draw(device, scene, VIEW)
    other = draw(device, scene, elsewhere)
    assert one.renderer.graph[MESH_BUFFERS] is other.renderer.graph[MESH_BUFFERS]
    assert wanted(one) == (0,)
    again = draw(device, scene, elsewhere, renderer=one.renderer)
    assert np.array_equal(again.color, other.color)


@pytest.mark.parametrize("seed", range(6))
def test_nothing_that_is_left_out_hides_any_light_of_what_is_seen(device, seed):
    """Rays from what a picture shows to its lights, through the meshes that it does not want, in float64."""
    random = np.random.default_rng(seed)
    count = 60
    places = np.stack(
        [transform(), *(transform(0.3 * random.normal(size=(3, 3)), 5.0 * random.normal(size=3)) for _ in range(count))]
    )
    lights = join_lights(
        *(
            light(position=4.0 * random.normal(size=3), axis_u=random.normal(size=3), axis_v=random.normal(size=3))
            for _ in range(2)
        )
    )
    scene = make_scene([FLOOR, *(random_triangles(100, seed=k) for k in range(count))], lights, places)
    view = look_at(3.0 * random.normal(size=3) + (0.0, 0.0, 4.0)) if seed % 2 else view_from_above(2.0)
    drawn = draw(device, scene, view)
    left_out = np.setdiff1d(np.arange(count + 1), wanted(drawn))
    assert len(left_out) > 5
    position = drawn.target("position")
    seen = position[position[..., 3] > 0.0][:, :3] + drawn.renderer.last[0].anchor
    starts = seen[random.integers(len(seen), size=400)]
    which, at = random.integers(2, size=400), random.uniform(-0.5, 0.5, (2, 400, 1))
    ends = lights.position[which] + at[0] * lights.axis_u[which] + at[1] * lights.axis_v[which]
    ahead = ((starts - lights.position[which]) * np.cross(lights.axis_u, lights.axis_v)[which]).sum(1) > 0.0
    others = replace(scene.instances, casts_shadow=np.isin(scene.instances.mesh, left_out))
    hidden, _ = reference_occlusion(replace(scene, instances=others), starts[ahead], ends[ahead])
    assert not hidden.any()
