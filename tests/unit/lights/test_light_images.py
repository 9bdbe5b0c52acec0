# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights with an image: by both methods, and at no cost without one. Compared with Cycles elsewhere."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.lights.modulation import MEAN_POINTS
from ism_addon.scene import Scene
from ism_addon.settings import Method
from tests.pictures.test_picture import SETTINGS
from tests.support.light_profiles import stripes
from tests.support.small_scenes import draw, light, make_scene, quad, view_from_above, with_quality
from tests.unit.lights.test_falloff import FLOOR, LIGHTS, PLATE, VIEW
from tests.unit.lights.test_light_profiles import constants_of_shaders, floor_points

STRIPES = stripes()
ELSEWHERE = quad((3, 3, 1.5), (0.05, 0, 0), (0, 0.05, 0))  # something that could cast a shadow


def with_stripes(scene: Scene) -> Scene:
    """The scene with an image that its lights have."""
    lights = replace(scene.lights, image=np.zeros(len(scene.lights.shape), np.int32))
    return replace(scene, lights=lights, light_images=(STRIPES,))


def colors_at(uv: np.ndarray) -> np.ndarray:
    """(N,3) of texture coordinates (N,2), interpolated linearly."""
    height, width = STRIPES.colors.shape[:2]
    texel = uv * (width, height) - 0.5
    first = np.floor(texel).astype(int)
    part = texel - first
    rows, columns = ([(first[:, k] + step) % n for step in (0, 1)] for k, n in ((1, height), (0, width)))
    below, above = (
        (1.0 - part[:, :1]) * STRIPES.colors[row, columns[0]] + part[:, :1] * STRIPES.colors[row, columns[1]]
        for row in rows
    )
    return (1.0 - part[:, 1:]) * below + part[:, 1:] * above


@pytest.mark.parametrize("method", Method)
def test_a_spot_without_a_radius_projects_it(device, method):
    """Across its cone of 1.6 rad, 2 m above the floor."""
    plain = make_scene([FLOOR], LIGHTS["spot"]())
    spread, (x, y, z) = float(plain.lights.spread[0]), plain.lights.position[0]
    scenes = with_stripes(plain), plain
    ours, without = (draw(device, each, VIEW, SETTINGS[method]).color[..., :3].reshape(-1, 3) for each in scenes)
    points = floor_points(4.0, 32) - (x, y, 0.0)
    axes = [axis / (axis @ axis) for axis in (plain.lights.axis_u[0], plain.lights.axis_v[0])]
    uv = np.stack([points @ axis for axis in axes], 1) / z * (0.5 / np.tan(spread / 2.0)) + 0.5
    expected = without * colors_at(np.clip(uv, 0.0, 1.0))
    assert expected.max() > 0.0
    assert np.abs(ours - expected).max() < 2e-3 * expected.max()


@pytest.mark.parametrize(("samples", "bound"), [(1, 0.03), (16, 0.003), (256, 0.001)])
def test_an_area_shines_in_its_colors(device, samples, bound):
    """A square over a floor, against the sum over a grid of its points. Measured: 0.016, 0.0013 and 0.0004."""
    scene = with_stripes(make_scene([FLOOR, ELSEWHERE], light()))
    settings = with_quality(SETTINGS[Method.RAY_TRACED], samples=samples)
    ours = draw(device, scene, view_from_above(4.0, (16, 16), height=0.9), settings).color[..., :3].reshape(-1, 3)
    across, points, theirs = (np.arange(48) + 0.5) / 48 - 0.5, floor_points(4.0, 16), np.zeros((256, 3))
    for x in across:
        for y in across:
            square = ((points - (x, y, 2.0)) ** 2).sum(1, keepdims=True)
            color = colors_at(np.array([[x + 0.5, 0.5 - y]]))  # its second axis is -y
            theirs += 0.6 / np.pi * 4.0 / square**2 * color / len(across) ** 2
    assert np.abs(ours - theirs).mean() < bound * theirs.mean()


def test_the_camera_sees_it(device):
    """A square that the camera looks up to."""
    up = light(position=(0.0, 0.0, 0.0), axis_v=(0.0, 1.0, 0.0), visible_camera=True)
    scene = with_stripes(make_scene([ELSEWHERE], up))
    seen = draw(device, scene, view_from_above(1.0, (32, 32)), with_quality(SETTINGS[Method.RAY_TRACED], samples=1))
    uv = floor_points(1.0, 32)[:, :2] + 0.5
    assert seen.color[..., :3].reshape(-1, 3) == pytest.approx(colors_at(uv), abs=2e-3)


def test_only_lights_with_an_image_need_a_shader_for_it():
    scene = make_scene([FLOOR, PLATE], light(visible_camera=True))
    assert constants_of_shaders(scene, "light_image") == {0}
    assert constants_of_shaders(with_stripes(scene), "light_image") == {MEAN_POINTS}
