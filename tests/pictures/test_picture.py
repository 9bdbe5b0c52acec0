# SPDX-License-Identifier: GPL-3.0-or-later
"""Three small scenes by both methods against a plain reference renderer."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from ism_addon.scene import Scene, View
from ism_addon.settings import SSAO, Method, Quality, Settings, Shadow
from tests.scenes.small import SMALL
from tests.support import reference
from tests.support.small_scenes import draw, with_quality

#: For each small scene, the reference's points along each side of a light, and for each method the bound of the root
#: of the mean squared error over the mean. Measured: 0.004, 0.004 and 0.024 by rays, 0.020, 0.023 and 0.069 by shadow
#: maps; up to 0.015 of the pillars' is the error of the reference itself.
BOUNDS = {
    "box over plane": (8, {Method.RAY_TRACED: 0.007, Method.SHADOW_MAPS: 0.03}),
    "sphere in corner": (6, {Method.RAY_TRACED: 0.007, Method.SHADOW_MAPS: 0.035}),
    "pillar field": (10, {Method.RAY_TRACED: 0.033, Method.SHADOW_MAPS: 0.10}),
}

SETTINGS = {
    Method.RAY_TRACED: Settings(
        shadow=Shadow(world=False),
        ssao=SSAO(enabled=False),
        quality=Quality(samples=64, error_threshold=0.0),
    ),
    Method.SHADOW_MAPS: Settings(
        shadow=Shadow(method=Method.SHADOW_MAPS),
        ssao=SSAO(enabled=False),
        quality=Quality(samples=1, virtual_lights=64, map_size=128, map_points=16384),
    ),
}

#: Changes of the shadow settings that must be noticed: each takes every scene over its bound.
BROKEN = {
    "no bias": {"bias": 0.0},
    "no shadows": {"enabled": False},
    "discs too small": {"splat_size": 0.4, "fill_holes": False},
    "discs too large": {"splat_size": 6.0},
}


SIZE = 48, 32


def small(name: str) -> tuple[Scene, View, np.ndarray, dict[Method, float]]:
    """Scene, view, reference picture (N,3) and bounds of a small scene."""
    side, bounds = BOUNDS[name]
    return *SMALL[name](*SIZE), reference.picture_of(SMALL[name], *SIZE, side), bounds


def without_shadows(scene: Scene) -> Scene:
    return replace(scene, lights=replace(scene.lights, casts_shadow=np.zeros_like(scene.lights.casts_shadow)))


def rgb(drawn) -> np.ndarray:
    """The colours of all pixels, (N,3)."""
    return drawn.color[..., :3].reshape(-1, 3)


@pytest.mark.parametrize("method", Method)
@pytest.mark.parametrize("name", SMALL)
def test_the_picture_is_that_of_the_reference(device, name, method):
    scene, view, truth, bounds = small(name)
    color = rgb(draw(device, scene, view, SETTINGS[method]))
    assert reference.nrmse(color, truth) < bounds[method]
    assert abs(color.mean() / truth.mean() - 1.0) < (0.005 if method == Method.RAY_TRACED else 0.02)


@pytest.mark.parametrize("name", SMALL)
def test_rays_come_closer_with_every_sample(device, name):
    """The error falls about as 1 / n while noise dominates: to less than 60 % between 1, 4, 16 and 64 samples."""
    scene, view, truth, _ = small(name)
    errors = []
    for samples in (1, 4, 16, 64):
        settings = with_quality(SETTINGS[Method.RAY_TRACED], samples=samples)
        errors.append(reference.nrmse(rgb(draw(device, scene, view, settings)), truth))
    assert all(later < 0.6 * earlier for earlier, later in pairwise(errors)), errors


@pytest.mark.parametrize("name", SMALL)
@pytest.mark.parametrize("broken", BROKEN)
def test_the_bound_notices_broken_shadow_maps(device, name, broken):
    scene, view, truth, bounds = small(name)
    settings = SETTINGS[Method.SHADOW_MAPS]
    settings = replace(settings, shadow=replace(settings.shadow, **BROKEN[broken]))
    assert reference.nrmse(rgb(draw(device, scene, view, settings)), truth) > 1.3 * bounds[Method.SHADOW_MAPS]


def narrower(scene):
    """Lights of half the width and the same power."""
    lights = scene.lights
    return replace(scene, lights=replace(lights, axis_u=0.5 * lights.axis_u, emission=2.0 * lights.emission))


def raised(scene):
    """All instances except the floor 3 cm higher."""
    matrices = scene.instances.world_from_object.copy()
    matrices[1:, 2, 3] += 0.03
    return replace(scene, instances=replace(scene.instances, world_from_object=matrices))


def with_ghosts(scene):
    """Every other instance casts no shadow."""
    casts_shadow = np.arange(len(scene.instances.mesh)) % 2 == 0
    return replace(scene, instances=replace(scene.instances, casts_shadow=casts_shadow))


@pytest.mark.parametrize("change", [narrower, raised, with_ghosts])
@pytest.mark.parametrize("name", SMALL)
def test_the_bound_notices_another_scene(device, name, change):
    scene, view, truth, bounds = small(name)
    color = rgb(draw(device, change(scene), view, SETTINGS[Method.RAY_TRACED]))
    assert reference.nrmse(color, truth) > 1.3 * bounds[Method.RAY_TRACED]


@pytest.mark.parametrize("method", Method)
@pytest.mark.parametrize("name", SMALL)
def test_unshadowed_pixels_are_exact(device, name, method):
    """Where all of every light is visible in the reference, nine pixels in ten are within 2 %."""
    scene, view, truth, _ = small(name)
    unshadowed_scene = without_shadows(scene)
    unshadowed_truth, surface = reference.picture(unshadowed_scene, view, BOUNDS[name][0])
    lit = surface.exists & (np.abs(unshadowed_truth - truth).max(1) < 1e-6)
    error = np.abs(rgb(draw(device, scene, view, SETTINGS[method])) - truth).max(1)[lit] / truth.max(1)[lit]
    assert lit.sum() > 300
    assert np.quantile(error, 0.9) < 0.02


@pytest.mark.parametrize("method", Method)
def test_without_shadows_the_picture_is_that_of_the_reference(device, method):
    for name, make in SMALL.items():
        scene, view = make(*SIZE)
        unshadowed_scene = without_shadows(scene)
        truth, surface = reference.picture(unshadowed_scene, view, 16)
        error = np.abs(rgb(draw(device, unshadowed_scene, view, SETTINGS[method])) - truth).max(1)[surface.exists]
        assert np.quantile(error / truth.max(1)[surface.exists], 0.98) < 0.02, name
