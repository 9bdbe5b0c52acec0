# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes in the light of a point, spot or sun, with and without a size, by both methods against the reference."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from ism_addon.scene import LightShape, Scene, View, World
from ism_addon.settings import Method, Shadow
from tests.pictures.test_picture import SETTINGS
from tests.scenes.small import SMALL
from tests.support import reference
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    draw,
    join_lights,
    light,
    make_scene,
    quad,
    transform,
    view_from_above,
    with_quality,
)

#: Bounds of the root mean square of the error over the mean, by radius (m). Measured: 0.0091 and 0.0033 by rays, 0.039
#: and 0.032 by shadow maps, 0.075 and 0.05 of spots. Without a radius it is in the few pixels that an edge crosses.
BOUNDS = {
    0.0: {Method.RAY_TRACED: 0.015, Method.SHADOW_MAPS: 0.09},
    0.3: {Method.RAY_TRACED: 0.007, Method.SHADOW_MAPS: 0.06},
}
FLOOR = quad((-4, -4, 0), (8, 0, 0), (0, 8, 0))


@cache
def case(name: str, shape: LightShape, radius: float) -> tuple[Scene, View, np.ndarray]:
    """A small scene with another light in place of its own, its view, and the reference picture (N,3).

    A spot or sun points where its own light did. A spot's cone ends within the picture.
    """
    scene, view = SMALL[name](48, 32)
    axes = (axis / np.linalg.norm(axis) for axis in (scene.lights.axis_u[0], scene.lights.axis_v[0]))
    spread = radius if shape == LightShape.SUN else 1.1
    one = light(shape, scene.lights.position[0], *axes, radius=radius, radiance=5.0, spread=spread, blend=0.4)
    one = replace(one, normal=scene.lights.normal[:1])
    scene = replace(scene, lights=one)
    return scene, view, reference.picture(scene, view, 20)[0]


@pytest.mark.parametrize("method", Method)
@pytest.mark.parametrize("radius", BOUNDS)
@pytest.mark.parametrize("shape", [LightShape.POINT, LightShape.SPOT, LightShape.SUN], ids=["point", "spot", "sun"])
@pytest.mark.parametrize("name", ["box over plane", "sphere in corner"])
def test_the_picture_is_that_of_the_reference(device, name, shape, radius, method):
    scene, view, truth = case(name, shape, radius)
    color = draw(device, scene, view, SETTINGS[method]).color[..., :3].reshape(-1, 3)
    assert reference.nrmse(color, truth) < BOUNDS[radius][method]
    assert abs(color.mean() / truth.mean() - 1.0) < (0.005 if method == Method.RAY_TRACED else 0.01)


@pytest.mark.parametrize("method", Method)
@pytest.mark.parametrize("radius", [0.0, 0.5])
def test_it_shines_upwards_and_downwards(device, radius, method):
    """A ceiling as far above the light as the floor is below it is as bright."""
    ceiling = quad((-4, 4, 4), (8, 0, 0), (0, -8, 0))
    one = light(LightShape.POINT, (0.0, 0.0, 2.0), radius=radius)
    settings = with_quality(SETTINGS[method], samples=1)
    view = view_from_above(3.0, (16, 16), height=1.0)
    upside_down = transform(np.diag([1.0, -1.0, -1.0]), (0.0, 0.0, 4.0))
    below = replace(view, view_from_world=view.view_from_world @ upside_down)
    floor, top = (
        draw(device, make_scene([FLOOR, ceiling], one), each, settings).color[..., 0] for each in (view, below)
    )
    assert floor.min() > 0.0
    assert top.mean() == pytest.approx(floor.mean(), rel=1e-5 if method == Method.RAY_TRACED else 3e-3)


@pytest.mark.parametrize("method", Method)
def test_a_spot_lights_nothing_outside_its_cone(device, method):
    """Tiles outside of it have no light, and a spot that looks away costs no ray and no map."""
    down = light(LightShape.SPOT, (0.0, 0.0, 2.0), (1, 0, 0), (0, -1, 0), spread=0.6, blend=0.2)
    up = light(LightShape.SPOT, (0.0, 0.0, 2.0), (1, 0, 0), (0, 1, 0), spread=0.6, blend=0.2)
    view = view_from_above(6.0, (96, 96), height=0.9)
    drawn = draw(device, make_scene([FLOOR], join_lights(down, up)), view, SETTINGS[method])
    x = (np.arange(96) + 0.5) / 16.0 - 3.0
    distance = np.hypot(x[:, None], x[None])
    lit = drawn.color[..., 0] > 0.0
    assert lit[distance < 2.0 * np.tan(0.3) - 0.1].all()
    assert not lit[distance > 2.0 * np.tan(0.3) + 0.1].any()
    assert drawn.profile.counts["lights_used"] == 1


@pytest.mark.parametrize("scale", [0.5, 0.8, 2.0])
def test_rays_do_not_brighten_elliptical_spots(device, scale):
    """Their irradiance is not exact, and some of a pixel's samples lie outside the cone: they count as dark."""
    spot = light(LightShape.SPOT, (0, 0, 2), (scale, 0, 0), (0, -1, 0), spread=0.8, blend=0.4, radius=0.2)
    scene = make_scene([FLOOR, quad((3, 3, 3), (0.1, 0, 0), (0, 0.1, 0))], spot)
    with_rays, without = (
        draw(
            device,
            scene,
            view_from_above(4.0, (32, 32)),
            replace(with_quality(SMALL_SETTINGS, samples=128), shadow=each),
        )
        for each in (Shadow(), Shadow(enabled=False))
    )
    assert with_rays.profile.counts["pairs_traced"] > 0
    assert with_rays.color[..., 0].mean() == pytest.approx(without.color[..., 0].mean(), rel=0.01)


def test_inside_a_sphere_light_comes_from_all_sides(device):
    """Radiance is uniform there: the irradiance is pi times it, whatever the normal."""
    one = light(LightShape.POINT, (0.3, -0.2, 0.4), radius=3.0, radiance=9.0 * np.pi)
    color = draw(device, make_scene([FLOOR], one), view_from_above(2.0, (16, 16)), SMALL_SETTINGS).color[..., 0]
    assert color == pytest.approx(np.full((16, 16), 0.6), rel=1e-5)


@pytest.mark.parametrize("shape", [LightShape.POINT, LightShape.SPOT, LightShape.SUN], ids=["point", "spot", "sun"])
@pytest.mark.parametrize("name", SMALL)
def test_shadows_of_lights_without_a_size_are_exact_after_one_sample(device, name, shape):
    """A pixel has all of the light or none, bit by bit, as the reference says at its centre.

    The few exceptions are thin shadows that no probe found, and pixels at the terminator of curved surfaces.
    """
    scene, view = SMALL[name](96, 64)
    axes = (axis / np.linalg.norm(axis) for axis in (scene.lights.axis_u[0], scene.lights.axis_v[0]))
    spread = 0.0 if shape == LightShape.SUN else 1.6
    one = light(shape, scene.lights.position[0], *axes, spread=spread, blend=0.3)
    one = replace(one, normal=scene.lights.normal[:1])
    scene = replace(scene, lights=one, world=World.even(np.zeros(3, np.float32)))
    without_shadow = replace(SMALL_SETTINGS, shadow=Shadow(enabled=False))
    color, unshadowed = (draw(device, scene, view, each).color[..., 0] for each in (SMALL_SETTINGS, without_shadow))
    # Cards fuse other operations in the two programs, which round to other values of 16-bit targets.
    rounding = 0.0 if device.name.startswith("llvmpipe") else 2.0**-10
    assert (np.isclose(color, unshadowed, rounding, 0.0) | (color == 0.0)).all()
    is_lit = reference.picture(scene, view, 1)[0][:, 0].reshape(color.shape) > 0.0
    assert ((color > 0.0) != is_lit).mean() < 0.003


@pytest.mark.parametrize("method", Method)
def test_the_camera_sees_lights_before_surfaces_and_not_behind_them(device, method):
    """A light that faces up to the camera, under one half of a roof; the camera sees the floor through it."""
    roof, seen = quad((-4, -4, 2), (4, 0, 0), (0, 8, 0)), {}
    for visible in (True, False):
        one = light(position=(0.0, 0.0, 1.0), axis_v=(0, 1, 0), radiance=3.0, visible_camera=visible)
        scene, settings = make_scene([FLOOR, roof], one), with_quality(SETTINGS[method], samples=1)
        seen[visible] = draw(device, scene, view_from_above(4.0, (32, 32)), settings).color[..., 0]
    x, y = np.meshgrid(*[(np.arange(32) + 0.5) / 8.0 - 2.0] * 2)
    expected = np.where((x > 0.0) & (x < 0.5) & (np.abs(y) < 0.5), 3.0, 0.0)
    assert seen[True] - seen[False] == pytest.approx(expected, abs=1e-5)
