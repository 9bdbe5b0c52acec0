# SPDX-License-Identifier: GPL-3.0-or-later
"""The blur smooths along surfaces and never across their edges."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.passes.occlusion.blur import BlurOcclusion
from ism_addon.gpu.profile import Profile
from ism_addon.resources.world import RAW_OCCLUSION
from ism_addon.settings import SSAO
from tests.support.small_scenes import SMALL_SETTINGS, draw, look_at, make_scene, quad, view_from_above, write_texels

SETTINGS = replace(SMALL_SETTINGS, ssao=SSAO())


def blurred(device, scene, view, occlusion: np.ndarray) -> np.ndarray:
    """(H/2,W/2): the blur of this occlusion (H/2,W/2), which replaces the result of SSAO."""
    drawn = draw(device, scene, view, SETTINGS)
    renderer = drawn.renderer
    write_texels(renderer.graph[RAW_OCCLUSION], occlusion.astype(np.float16))
    frame = renderer.frame(scene, view, SETTINGS, 0, Profile())
    renderer.graph.instance(BlurOcclusion).execute(frame)
    return drawn.target("ambient_occlusion")[..., 0]


def floor():
    return quad((-10, -10, 0), (20, 0, 0), (0, 20, 0))


def test_noise_is_smoothed_and_the_mean_stays_the_same(device):
    noise = np.random.default_rng(0).random((24, 32))
    result = blurred(device, make_scene([floor()], world=1.0), look_at((0.0, -4.0, 3.0), size=(64, 48)), noise)
    assert result.std() < 0.35 * noise.std()
    assert result.mean() == pytest.approx(noise.mean(), abs=0.01)


def test_a_constant_stays_the_same(device):
    result = blurred(
        device, make_scene([floor()], world=1.0), look_at((0.0, -4.0, 3.0), size=(64, 48)), np.full((24, 32), 0.25)
    )
    assert result == pytest.approx(0.25, abs=1e-3)


def test_on_a_plane_it_is_a_tent_filter_of_seven_pixels(device):
    dot = np.zeros((24, 24))
    dot[12, 12] = 1.0
    result = blurred(device, make_scene([floor()], world=1.0), view_from_above(4.0, (48, 48)), dot)
    kernel = np.array([1, 2, 3, 4, 3, 2, 1]) / 16.0
    assert result[9:16, 9:16] == pytest.approx(np.outer(kernel, kernel), abs=1e-3)
    assert result.sum() == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("height", [0.5, 2.0])
def test_occlusion_does_not_bleed_over_a_step(device, height):
    """The left half of the picture is a raised plate. It is black, and the floor is white."""
    plate = quad((-10, -10, height), (10, 0, 0), (0, 20, 0))
    black = np.repeat((np.arange(24) >= 12)[None], 24, 0).astype(float)
    result = blurred(device, make_scene([floor(), plate], world=1.0), view_from_above(4.0, (48, 48)), black)
    assert np.array_equal(result, black)


def test_occlusion_does_not_bleed_over_a_crease(device):
    wall = quad((-10, 0, 0), (20, 0, 0), (0, 0, 20))
    view = look_at((0.0, -4.0, 4.0), size=(48, 48))
    rows = np.repeat((np.arange(24) >= 12)[:, None], 24, 1).astype(float)
    result = blurred(device, make_scene([floor(), wall], world=1.0), view, rows)
    assert np.abs(result - rows).max() < 1e-3


def test_the_background_does_not_bleed_onto_surfaces(device):
    """A narrow black plate before a white background stays black."""
    plate = quad((-0.5, -10, 0), (1, 0, 0), (0, 20, 0))
    view = view_from_above(4.0, (48, 48))
    white = np.ones((24, 24))
    white[:, 9:15] = 0.0
    result = blurred(device, make_scene([plate], world=1.0), view, white)
    assert not result[:, 9:15].any()
