# SPDX-License-Identifier: GPL-3.0-or-later
"""The allocation of virtual lights: by importance, with the requested sum, and unchanged by small camera moves."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ism_addon.color import REC709
from ism_addon.gpu.passes.shadow_maps.light_importance import importance
from ism_addon.gpu.passes.shadow_maps.virtual_lights import allocate_virtual_lights
from ism_addon.resources import MAP_POINTS, VIRTUAL_LIGHT_COUNTS
from ism_addon.sampling.point_cloud import make_point_cloud
from ism_addon.scene import LightShape
from tests.scenes.rooms import rooms
from tests.scenes.small import subdivided_box
from tests.support import reference
from tests.support.small_scenes import (
    SMALL_SHADOW_MAPS,
    draw,
    join_lights,
    light,
    look_at,
    make_scene,
    quad,
    view_from_above,
    with_quality,
)

SIZE = 160, 96
#: The lights of the room that is visible in tests/scenes/rooms.py.
ROOM_LIGHTS = range(5)
FLOOR = quad((-4, -4, 0), (8, 0, 0), (0, 8, 0))


def small_light(x: float, y: float, z: float, **more: object):
    return light(LightShape.ELLIPSE, (x, y, z), (0.05, 0, 0), (0, -0.05, 0), **{"radiance": 10.0, **more})


def virtual_light_counts(device, scene, view, renderer=None, **quality: int) -> dict[int, int]:
    """Virtual lights of each contributing light."""
    return draw(device, scene, view, with_quality(SMALL_SHADOW_MAPS, **quality), renderer).renderer.graph[
        VIRTUAL_LIGHT_COUNTS
    ]


def drawn_rooms(device, idle: dict[str, int], **changes: object):
    """One sample of the room with five lights, and idle ones."""
    return draw(device, *rooms(idle, *SIZE), replace(with_quality(SMALL_SHADOW_MAPS, virtual_lights=60), **changes))


@pytest.mark.parametrize("count", [1, 7, 40, 333])
def test_large_lights_have_many_virtual_lights_small_and_far_ones_have_few(device, count):
    lights = light(axis_u=(2.0, 0, 0), axis_v=(0, -2.0, 0))
    for position in ((1.0, 1.0, 3.0), (-1.0, 0.5, 3.0), (0.0, 0.0, 9.0)):
        lights = join_lights(lights, small_light(*position))
    counts = virtual_light_counts(device, make_scene([FLOOR], lights), view_from_above(6.0), virtual_lights=count)
    assert sum(counts.values()) == max(count, 4)
    assert min(counts.values()) == 1
    if count == 40:
        assert counts[0] >= 34
        assert max(counts[light] for light in (1, 2, 3)) <= 2


def test_brighter_and_nearer_lights_have_more_virtual_lights(device):
    weak, bright, far = small_light(-1, 0, 2), small_light(1, 0, 2, radiance=60.0), small_light(0, 1, 6)
    counts = virtual_light_counts(
        device,
        make_scene([FLOOR], join_lights(join_lights(weak, bright), far)),
        view_from_above(6.0),
        virtual_lights=100,
    )
    assert counts[1] > 2 * counts[0] > 4 * counts[2]


@settings(deadline=None, derandomize=True)
@given(st.integers(1, 3000), st.lists(st.floats(0.0, 1e6), min_size=1, max_size=20))
def test_the_sum_is_as_requested_and_each_light_has_at_least_one(count, weights):
    lights = list(range(0, len(weights), 2))
    counts = allocate_virtual_lights(lights, np.array(weights), np.ones(len(weights), int), count)
    assert list(counts) == lights
    assert min(counts.values()) >= 1
    assert sum(counts.values()) == max(count, len(lights))


def test_importance_does_not_depend_on_the_unit_of_radiance():
    lights = join_lights(light(axis_u=(2.0, 0, 0)), join_lights(small_light(1, 0, 2), small_light(0, 0, 5)))
    cloud = make_point_cloud(make_scene([FLOOR], lights), np.zeros(3), 5000)
    weights = importance(cloud, lights, np.zeros(3), REC709)
    brighter = replace(lights, emission=np.float32(7.0) * lights.emission)
    assert importance(cloud, brighter, np.zeros(3), REC709) == pytest.approx(weights, rel=1e-4)
    assert weights[0] > 3.0 * weights[1] > 6.0 * weights[2]


@pytest.mark.parametrize("why", ["turned away", "elsewhere"])
def test_lights_that_reach_nothing_have_no_virtual_lights(device, why):
    alone, drawn = drawn_rooms(device, {}), drawn_rooms(device, {why: 40})
    counts = drawn.renderer.graph[VIRTUAL_LIGHT_COUNTS]
    assert set(counts) == set(ROOM_LIGHTS)
    assert sum(counts.values()) == drawn.profile.counts["virtual_lights"] == 60
    assert drawn.profile.counts["lights_used"] == 5
    assert drawn.color[..., :3].mean() == pytest.approx(alone.color[..., :3].mean(), rel=0.01)
    without_culling = drawn_rooms(device, {why: 40}, shortcuts=False)
    assert set(without_culling.renderer.graph[VIRTUAL_LIGHT_COUNTS]) == set(range(45))


def test_lights_that_reach_nothing_have_no_map_points(device):
    """No map of theirs would use them."""
    alone, with_idle = (drawn_rooms(device, idle).renderer.graph[MAP_POINTS] for idle in ({}, {"turned away": 40}))
    assert with_idle.buffer.size == alone.buffer.size > 0


def test_occluded_lights_keep_virtual_lights(device):
    """Only their maps show that they are occluded."""
    counts = drawn_rooms(device, {"hidden": 40}).renderer.graph[VIRTUAL_LIGHT_COUNTS]
    assert set(counts) > set(ROOM_LIGHTS)
    assert sum(counts.values()) == 60


def test_faint_lights_have_virtual_lights_only_where_no_others_contribute(device):
    counts = drawn_rooms(device, {"faint": 40}).renderer.graph[VIRTUAL_LIGHT_COUNTS]
    assert len(set(counts) - set(ROOM_LIGHTS)) <= 4


@pytest.mark.parametrize("metres", [0.003, -0.01, 0.3])
def test_a_small_move_of_the_camera_draws_no_map(device, metres):
    scene, view = rooms({}, *SIZE)
    view_from_world = view.view_from_world.copy()
    view_from_world[:3, 3] += metres
    moved, settings = replace(view, view_from_world=view_from_world), with_quality(SMALL_SHADOW_MAPS, virtual_lights=60)
    first = draw(device, scene, view, settings)
    counts = first.renderer.graph[VIRTUAL_LIGHT_COUNTS]
    again = draw(device, scene, moved, settings, first.renderer)
    rows = again.profile.rows
    assert rows["CullLights"].drawn
    assert not rows["PlaceVirtualLights"].drawn + rows["SplatMaps"].drawn + rows["FillHoles"].drawn
    assert again.renderer.graph[VIRTUAL_LIGHT_COUNTS] == counts
    assert np.array_equal(again.color, draw(device, scene, moved, settings).color)


def test_the_allocation_does_not_depend_on_earlier_pictures(device):
    """A picture of the sky, where no light contributes, is drawn in between."""
    scene, view = rooms({}, *SIZE)
    sky = look_at((0.6, 0.4, 40.0), (0.6, 9.0, 80.0), SIZE)
    settings = with_quality(SMALL_SHADOW_MAPS, samples=5, virtual_lights=60)
    first = draw(device, scene, view, settings)
    color, counts = first.color, first.renderer.graph[VIRTUAL_LIGHT_COUNTS]
    between = draw(device, scene, sky, settings, first.renderer)
    assert between.renderer.graph[VIRTUAL_LIGHT_COUNTS] == {}
    again = draw(device, scene, view, settings, first.renderer)
    assert again.renderer.graph[VIRTUAL_LIGHT_COUNTS] == counts
    assert np.array_equal(again.color, color)


def test_lights_that_cast_no_shadow_have_no_virtual_lights_but_contribute(device):
    lights = join_lights(light(casts_shadow=False), small_light(1.0, 1.0, 3.0))
    scene = make_scene([FLOOR, subdivided_box((-0.5, -0.5, 0.3), (0.5, 0.5, 0.8), 2)], lights)
    assert virtual_light_counts(device, scene, view_from_above(6.0), virtual_lights=20) == {0: 0, 1: 20}
    unshadowed = replace(scene, lights=replace(lights, casts_shadow=np.zeros(2, bool)))
    drawn = draw(device, unshadowed, view_from_above(6.0), SMALL_SHADOW_MAPS)
    assert drawn.renderer.graph[VIRTUAL_LIGHT_COUNTS] == {0: 0, 1: 0}
    assert drawn.color[..., :3].max() > 0.1


def test_no_map_is_drawn_for_a_background(device):
    drawn = draw(
        device, make_scene([quad((50, 50, 0), (1, 0, 0), (0, 1, 0))], light()), view_from_above(4.0), SMALL_SHADOW_MAPS
    )
    assert drawn.renderer.graph[VIRTUAL_LIGHT_COUNTS] == {}
    assert not drawn.profile.rows["SplatMaps"].drawn + drawn.profile.rows["FillHoles"].drawn
    assert not drawn.target("direct_prediction")[..., :3].any()


def test_the_mean_of_the_picture_is_correct(device):
    """A large and a small light, one that casts no shadow, and one that reaches nothing."""
    lights = join_lights(light(axis_u=(1.5, 0, 0), axis_v=(0, -1.5, 0)), small_light(1.0, -1.0, 3.0, radiance=400.0))
    lights = join_lights(lights, light(position=(-1.0, 1.0, 3.0), casts_shadow=False))
    lights = join_lights(lights, light(position=(0.0, 0.0, 3.0), axis_v=(0, 1.0, 0), radiance=100.0))
    scene = make_scene([FLOOR, subdivided_box((-0.5, -0.5, 0.0), (0.5, 0.5, 0.8), 4)], lights)
    view = look_at((2.5, -4.0, 3.0), size=(48, 32))
    truth, _ = reference.picture(scene, view, 12)
    settings = with_quality(SMALL_SHADOW_MAPS, samples=4, virtual_lights=32, map_size=128, map_points=16384)
    drawn = draw(device, scene, view, settings)
    assert set(drawn.renderer.graph[VIRTUAL_LIGHT_COUNTS]) == {0, 1, 2}
    assert drawn.color[..., :3].mean() == pytest.approx(truth.mean(), rel=0.02)


def test_a_point_light_without_a_radius_gets_virtual_lights_beside_one_with_a_radius(device):
    """Its shadows are as imperfect."""
    lights = join_lights(*(light(LightShape.POINT, (x, 0.0, 2.0), radius=r) for x, r in ((-1.0, 0.0), (1.0, 0.5))))
    scene, settings = make_scene([quad((-3, -3, 0), (6, 0, 0), (0, 6, 0))], lights), SMALL_SHADOW_MAPS
    drawn = draw(device, scene, view_from_above(4.0), with_quality(settings, virtual_lights=60))
    counts = drawn.renderer.graph[VIRTUAL_LIGHT_COUNTS]
    assert sum(counts.values()) == 60
    assert 2 < counts[0] < counts[1]
