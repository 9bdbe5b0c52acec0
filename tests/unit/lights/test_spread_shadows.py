# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadows of lights with a spread, which light a receiver with part of their area: both methods against dense sums."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.settings import Settings
from tests.support import reference
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    SMALL_SHADOW_MAPS,
    draw,
    light,
    make_scene,
    quad,
    view_from_above,
    with_quality,
)

#: By method: settings, and the largest error, as RMSE over the mean and as a ratio of the means.
METHODS = {
    "rays": (with_quality(SMALL_SETTINGS, samples=128), 0.06, 0.01),
    "maps": (with_quality(SMALL_SHADOW_MAPS, samples=4, virtual_lights=64, map_size=64, map_points=16384), 0.28, 0.18),
}


def half_covered(degrees: float):
    """Scene and view of a floor, half of it below a plate that is invisible to the camera.

    The light is 2 m wide and 1 m above the floor.
    """
    lights = light(position=(0.0, 0.0, 1.0), axis_u=(2.0, 0.0, 0.0), axis_v=(0.0, -2.0, 0.0))
    lights = replace(lights, spread=np.array([math.radians(degrees)], np.float32))
    floor, plate = (-2.0, -2.0, 0.0), (-3.0, -3.0, 0.5)
    meshes = quad(floor, (4.0, 0.0, 0.0), (0.0, 4.0, 0.0)), quad(plate, (3.0, 0.0, 0.0), (0.0, 6.0, 0.0))
    scene = make_scene(meshes, lights)
    return replace(scene, instances=replace(scene.instances, visible=np.array([True, False]))), view_from_above(
        1.6, (24, 8)
    )


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("degrees", [40.0, 90.0])
def test_half_of_the_light_is_occluded(device, method, degrees):
    scene, view = half_covered(degrees)
    truth, (settings, error, ratio) = reference.picture(scene, view, 24)[0], METHODS[method]
    color = draw(device, scene, view, settings).color[..., :3].reshape(-1, 3)
    assert reference.nrmse(color, truth) < error
    assert color.mean() / truth.mean() == pytest.approx(1.0, abs=ratio)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("degrees", [0.5, 10.0])
def test_a_narrow_spread_casts_a_shadow(device, method, degrees):
    """With maps, most receivers are lit by none of the virtual lights: they take their neighbours' visibility."""
    scene, view = half_covered(degrees)
    settings = with_quality(METHODS[method][0], samples=4)
    pictures = [draw(device, scene, view, each).color[..., 0] for each in (settings, without_shadows(settings))]
    visibility = (pictures[0] / pictures[1]).mean(0)
    assert visibility[:8].max() < 0.1
    assert visibility[16:].min() > 0.9


def without_shadows(settings: Settings) -> Settings:
    return replace(settings, shadow=replace(settings.shadow, enabled=False))
