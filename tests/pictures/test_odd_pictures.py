# SPDX-License-Identifier: GPL-3.0-or-later
"""Both methods with scenes that lack something, are degenerate or far from the origin, and with shadows disabled."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.settings import SSAO
from tests.scenes.small import SMALL, mesh
from tests.support import reference
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
    with_quality,
)

BOTH_METHODS = pytest.mark.parametrize("base", [SMALL_SETTINGS, SMALL_SHADOW_MAPS], ids=["rays", "maps"])


@pytest.mark.parametrize("offset", [1e4, 1e6])
@BOTH_METHODS
def test_far_from_the_origin_the_picture_is_the_same(device, base, offset):
    """Camera, lights and meshes are moved together."""
    far = np.array([offset, -offset, offset])
    area_light = light(position=(0.3, 0.0, 2.0))
    near_origin = draw(
        device,
        make_scene([random_triangles(), quad((-2, -2, -1), (4, 0, 0), (0, 4, 0))], area_light),
        look_at((3, -3, 2)),
        base,
    )
    moved_light = replace(area_light, position=area_light.position + far)
    scene = make_scene(
        [random_triangles(), quad((-2, -2, -1), (4, 0, 0), (0, 4, 0))],
        moved_light,
        matrices=[transform(offset=far)] * 2,
    )
    far_away = draw(device, scene, look_at(far + (3, -3, 2), far), base)
    assert reference.nrmse(far_away.color[..., :3], near_origin.color[..., :3]) < 0.05


@BOTH_METHODS
def test_no_meshes(device, base):
    drawn = draw(device, make_scene([], light(), world=0.2), look_at((3, -3, 2)), base)
    assert drawn.color == pytest.approx(np.broadcast_to([0.2, 0.2, 0.2, 1.0], (24, 32, 4)))


@BOTH_METHODS
def test_no_lights(device, base):
    drawn = draw(device, make_scene([quad((-9, -9, 0), (18, 0, 0), (0, 18, 0))], world=0.5), look_at((3, -3, 6)), base)
    assert drawn.color[..., :3] == pytest.approx(0.3, abs=1e-3)
    assert drawn.profile.rows["SplatMaps"].drawn == drawn.profile.rows["GatherLight"].drawn == 0


@BOTH_METHODS
def test_neither_lights_nor_meshes_nor_a_world(device, base):
    assert not draw(device, make_scene([]), look_at((3, -3, 2)), base).color[..., :3].any()


def floor_and_plate():
    return [quad((-2, -2, 0), (4, 0, 0), (0, 4, 0)), quad((-0.5, -0.5, 1.0), (1, 0, 0), (0, 1, 0))]


@BOTH_METHODS
def test_an_unshadowed_light_among_others(device, base):
    """The picture is the sum of each light's own picture, with its shadow or without."""
    one, other = light(position=(1.0, 0.0, 2.0), casts_shadow=False), light(position=(-1.0, 0.0, 2.0))
    settings = with_quality(base, virtual_lights=32)
    together = draw(device, make_scene(floor_and_plate(), join_lights(one, other)), look_at((3, -3, 3)), settings).color
    separate = [
        draw(device, make_scene(floor_and_plate(), area_light), look_at((3, -3, 3)), settings).color
        for area_light in (one, other)
    ]
    assert reference.nrmse(together[..., :3], separate[0][..., :3] + separate[1][..., :3]) < 0.15
    shadowed = draw(
        device,
        make_scene(floor_and_plate(), replace(one, casts_shadow=np.array([True]))),
        look_at((3, -3, 3)),
        settings,
    ).color
    assert (separate[0] - shadowed)[..., :3].max() > 0.01


@BOTH_METHODS
def test_an_object_without_shadow_is_visible_and_casts_none(device, base):
    scene = make_scene(floor_and_plate(), light())
    without_shadow = replace(scene, instances=replace(scene.instances, casts_shadow=np.array([True, False])))
    floor_only = make_scene(floor_and_plate()[:1], light())
    view = look_at((0.0, -6.0, 0.5), (0.0, 0.0, 0.5))
    drawn, expected = draw(device, without_shadow, view, base), draw(device, floor_only, view, base)
    floor = (drawn.target("primitive")[..., 0] <= 2) & (drawn.target("primitive")[..., 0] > 0)
    assert np.abs(drawn.color - expected.color)[floor].max() < 0.01
    assert np.abs(drawn.color - draw(device, scene, view, base).color)[floor].max() > 0.012


@BOTH_METHODS
def test_an_invisible_object_may_cast_a_shadow(device, base):
    scene = make_scene(floor_and_plate(), light())
    hidden = replace(scene, instances=replace(scene.instances, visible=np.array([True, False])))
    drawn = draw(device, hidden, look_at((0.0, -3.0, 4.0)), base)
    assert set(np.unique(drawn.target("primitive")[..., 0])) <= {0, 1, 2}
    without_plate = draw(device, make_scene(floor_and_plate()[:1], light()), look_at((0.0, -3.0, 4.0)), base)
    assert (without_plate.color - drawn.color).max() > 0.03


def points_only():
    """A mesh whose triangles have no area."""
    up = np.broadcast_to(np.array([0.0, 0.0, 1.0]), (20, 3, 3))
    return mesh(np.random.default_rng(0).normal(size=(20, 3)), np.arange(20)[:, None].repeat(3, 1), up)


DEGENERATE = {
    "a mesh of points": lambda: make_scene([points_only()], light(), world=0.1),
    "a flat instance": lambda: make_scene(
        [random_triangles(20)], light(), matrices=[transform(np.diag([1.0, 1.0, 0.0]))], world=0.1
    ),
    "a light in the floor": lambda: make_scene(floor_and_plate(), light(position=(0.0, 0.0, 0.0)), world=0.1),
    "a light of no size": lambda: make_scene(
        floor_and_plate(), light(axis_u=(1e-9, 0, 0), axis_v=(0, -1e-9, 0)), world=0.1
    ),
    "a light of no power": lambda: make_scene(floor_and_plate(), light(radiance=0.0), world=0.1),
    "a huge light": lambda: make_scene(floor_and_plate(), light(axis_u=(1e5, 0, 0), axis_v=(0, -1e5, 0)), world=0.1),
    "a very bright light": lambda: make_scene(floor_and_plate(), light(radiance=1e30), world=0.1),
    "a narrow spread": lambda: make_scene(floor_and_plate(), light(spread=0.0), world=0.1),
    "a tiny scene": lambda: make_scene(
        [random_triangles(50)], light(), matrices=[transform(1e-6 * np.eye(3))], world=0.1
    ),
    "a vast scene": lambda: make_scene(
        [random_triangles(50)], light(), matrices=[transform(1e7 * np.eye(3))], world=0.1
    ),
}


@pytest.mark.parametrize("name", DEGENERATE)
@BOTH_METHODS
def test_no_pixel_is_nan_or_negative(device, base, name):
    settings = replace(base, ssao=SSAO(), quality=replace(base.quality, samples=2))
    color = draw(device, DEGENERATE[name](), look_at((0.0, -4.0, 3.0)), settings).color
    assert np.isfinite(color).all()
    assert color.min() >= 0.0


@pytest.mark.parametrize(
    "quality", [{"virtual_lights": 1}, {"map_points": 1}, {"map_size": 8}, {"virtual_lights": 3, "map_size": 1000}]
)
def test_the_lowest_quality_gives_a_picture(device, quality):
    scene, view = SMALL["sphere in corner"](24, 16)
    color = draw(device, scene, view, with_quality(SMALL_SHADOW_MAPS, **quality)).color
    assert np.isfinite(color).all()
    assert color[..., :3].mean() > 0.05


@pytest.mark.parametrize("size", [(1, 1), (1, 40), (37, 1)])
@BOTH_METHODS
def test_pictures_of_few_pixels(device, base, size):
    scene, view = SMALL["box over plane"](*size)
    settings = replace(base, ssao=SSAO())
    color = draw(device, scene, view, settings).color
    assert color.shape == (size[1], size[0], 4)
    assert np.isfinite(color).all()
