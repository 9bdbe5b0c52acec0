# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights with a profile: by both methods, and at no cost without one. Compared with Cycles elsewhere."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.gl.context import open_device
from ism_addon.gpu.lights.modulation import MEAN_POINTS
from ism_addon.scene import Scene
from ism_addon.settings import Method, Shadow
from tests.pictures.lights.test_shadow_softness import FEW_SAMPLES
from tests.pictures.test_picture import SETTINGS
from tests.support.light_profiles import beam
from tests.support.small_scenes import draw, light, make_scene, quad, view_from_above, with_quality
from tests.unit.lights.test_falloff import FLOOR, LIGHTS, PLATE, VIEW

BEAM = beam()
#: Axes of a profile that is rotated by 0.4 and, in proportion to its third axis, stretched along the first one.
AXES = np.array([[1.5, 0.0, 0.0], [0.0, np.cos(0.4), -np.sin(0.4)], [0.0, -np.sin(0.4), -np.cos(0.4)]])


def with_beam(scene: Scene) -> Scene:
    """The scene with a profile in a rotated space, which its lights have."""
    count = len(scene.lights.shape)
    lights = replace(scene.lights, profile=np.zeros(count, np.int32), profile_axes=np.tile(AXES, (count, 1, 1)))
    return replace(scene, lights=lights, light_profiles=(BEAM,))


def factors(points: np.ndarray, position: np.ndarray) -> np.ndarray:
    """(N,) the profile's factors from one position to points (N,3)."""
    return BEAM.at((points - position) @ AXES.T * (1.0, 1.0, -1.0))


def floor_points(width: float, pixels: int) -> np.ndarray:
    """(N,3) m: the pixels' centres of a square view from above."""
    middle = ((np.arange(pixels) + 0.5) / pixels - 0.5) * width
    return np.stack([*np.meshgrid(middle, middle), np.zeros((pixels, pixels))], -1).reshape(-1, 3)


@pytest.mark.parametrize("name", ["point", "spot"])
def test_a_light_of_one_point_is_exact(device, name):
    plain = make_scene([FLOOR], LIGHTS[name]())
    scene = with_beam(plain)
    ours, without = (draw(device, each, VIEW).color[..., 0] for each in (scene, plain))
    expected = without * factors(floor_points(4.0, 32), scene.lights.position[0]).reshape(32, 32)
    assert expected.max() > 4.0 * np.median(expected)
    assert np.abs(ours - expected).max() < 1e-3 * expected.max()


@pytest.mark.parametrize(("samples", "bound"), [(1, 0.03), (16, 0.005), (256, 0.001)])
def test_the_profile_of_a_large_light_is_that_of_all_of_its_points(device, samples, bound):
    """A square over a floor, against the sum over a grid of its points. Measured: 0.02, 0.003 and 0.0004."""
    elsewhere = quad((3, 3, 1.5), (0.05, 0, 0), (0, 0.05, 0))  # something that could cast a shadow
    scene = with_beam(make_scene([FLOOR, elsewhere], light()))
    settings = with_quality(SETTINGS[Method.RAY_TRACED], samples=samples)
    ours = draw(device, scene, view_from_above(4.0, (16, 16), height=0.9), settings).color[..., 0].ravel()
    across, points, theirs = (np.arange(24) + 0.5) / 24 - 0.5, floor_points(4.0, 16), np.zeros(256)
    for x in across:
        for y in across:
            position = np.array([x, y, 2.0])
            square = ((points - position) ** 2).sum(1)
            theirs += 0.6 / np.pi * 4.0 / square**2 * factors(points, position) / 24**2
    assert np.abs(ours - theirs).mean() < bound * theirs.mean()


@pytest.mark.parametrize("method", Method)
@pytest.mark.parametrize("name", LIGHTS)
def test_shadows_are_as_dark_as_without_a_profile(device, name, method):
    """Directions hardly differ over a light."""
    with_shadows, without = FEW_SAMPLES[method], replace(FEW_SAMPLES[method], shadow=Shadow(enabled=False))
    visible, plain = [], make_scene([FLOOR, PLATE], LIGHTS[name]())
    weights = draw(device, with_beam(plain), VIEW, without).color[..., 0]  # elsewhere there is more noise than light
    for scene in (with_beam(plain), plain):
        shadowed, unshadowed = (draw(device, scene, VIEW, each).color[..., 0] for each in (with_shadows, without))
        visible.append(np.divide(shadowed, unshadowed, out=np.zeros_like(shadowed), where=unshadowed > 0.0))
    assert (visible[1] < 0.9).mean() > 0.05
    assert np.average(np.abs(visible[0] - visible[1]), weights=weights) < 0.08


def constants_of_shaders(scene: Scene, name: str) -> set[int | float]:
    """The values of a constant in all shaders that a picture of the scene needs."""
    device = open_device()
    with device.gl:
        draw(device, scene, VIEW, with_quality(SETTINGS[Method.RAY_TRACED], samples=2))
    values = {value for _, _, constants in device.programs for key, value in constants if key == name}
    device.close()
    return values


def test_only_lights_with_a_profile_need_a_shader_for_it():
    scene = make_scene([FLOOR, PLATE], light(visible_camera=True))
    assert constants_of_shaders(scene, "profile") == {0}
    assert constants_of_shaders(with_beam(scene), "profile") == {MEAN_POINTS}
