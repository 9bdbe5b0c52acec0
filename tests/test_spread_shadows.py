# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadows of lights with a spread, of which a receiver sees a part only: by both methods, against dense sums."""

import math
from dataclasses import replace

import numpy as np
import pytest

from . import reference
from .studio import MAPS, SMALL_SETTINGS, draw, from_above, light, quad, stage, with_quality

#: By method: settings, and how far off pictures may be, as RMSE over the mean and as a ratio of the means.
METHODS = {
    "rays": (with_quality(SMALL_SETTINGS, samples=256), 0.06, 0.01),
    "maps": (with_quality(MAPS, samples=8, light_points=64, map_size=64, surface_points=16384), 0.28, 0.18),
}


@pytest.fixture(scope="module")
def half_open():
    """half_open(degrees): scene, view and truth of a floor, half of it below a plate that the camera does not see.

    The light is 2 m wide and 1 m above the floor.
    """

    def half_open(degrees: float):
        lights = light(position=(0.0, 0.0, 1.0), axis_u=(2.0, 0.0, 0.0), axis_v=(0.0, -2.0, 0.0))
        lights = replace(lights, spread=np.array([math.radians(degrees)], np.float32))
        floor, plate = (-2.0, -2.0, 0.0), (-3.0, -3.0, 0.5)
        meshes = quad(floor, (4.0, 0.0, 0.0), (0.0, 4.0, 0.0)), quad(plate, (3.0, 0.0, 0.0), (0.0, 6.0, 0.0))
        scene = stage(meshes, lights)
        scene = replace(scene, instances=replace(scene.instances, visible=np.array([True, False])))
        view = from_above(1.6, (24, 8))
        return scene, view, reference.picture(scene, view, 24)[0]

    return half_open


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("degrees", [40.0, 90.0])
def test_half_of_what_a_receiver_sees_is_hidden(device, half_open, method, degrees):
    scene, view, truth = half_open(degrees)
    settings, error, ratio = METHODS[method]
    color = draw(device, scene, view, settings).color[..., :3].reshape(-1, 3)
    assert reference.nrmse(color, truth) < error
    assert color.mean() / truth.mean() == pytest.approx(1.0, abs=ratio)
