# SPDX-License-Identifier: GPL-3.0-or-later
"""Shading: linear light, the world as background, and ambient occlusion upsampled to full resolution."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.passes.film.shade import Shade
from ism_addon.gpu.profile import Profile
from ism_addon.resources import DIRECT_PREDICTION, DIRECT_RESIDUAL
from ism_addon.resources.world import AMBIENT_OCCLUSION
from ism_addon.settings import SSAO
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    SMALL_SHADOW_MAPS,
    draw,
    light,
    look_at,
    make_scene,
    quad,
    view_from_above,
    with_quality,
    write_texels,
)


def lit_floor(**more):
    return make_scene(
        [quad((-1, -1, 0), (2, 0, 0), (0, 2, 0))], light(radiance=5.0), world=0.3, base_color=(0.8, 0.4, 0.1), **more
    )


@pytest.mark.parametrize("settings", [SMALL_SETTINGS, SMALL_SHADOW_MAPS])
def test_direct_light_and_base_color_times_the_world(device, settings):
    drawn = draw(device, lit_floor(), look_at((0.0, -4.0, 3.0)), settings)
    is_surface = drawn.target("position")[..., 3] > 0.0
    expected = drawn.target("direct_prediction")[..., :3] + np.array([0.8, 0.4, 0.1]) * 0.3
    assert 0 < is_surface.sum() < is_surface.size
    assert drawn.color[is_surface][:, :3] == pytest.approx(expected[is_surface], rel=2e-3)
    assert (drawn.color[is_surface][:, 3] == 1.0).all()
    assert np.ptp(drawn.target("direct_prediction")[is_surface]) > 0.1


def test_a_residual_is_passed_on_unchanged(device):
    """Also its alpha, the uncertain luminance. The headroom is in another target."""
    settings = with_quality(SMALL_SETTINGS, samples=2)
    drawn = draw(device, lit_floor(), look_at((0.0, -4.0, 3.0)), settings)
    residuals = np.random.default_rng(0).normal(size=(24, 32, 4))
    write_texels(drawn.renderer.graph[DIRECT_RESIDUAL], residuals.astype(np.float32))
    write_texels(drawn.renderer.graph[DIRECT_PREDICTION], np.abs(residuals).astype(np.float32))
    frame = drawn.renderer.frame(lit_floor(), look_at((0.0, -4.0, 3.0)), settings, 1, Profile())
    drawn.renderer.graph.instance(Shade).execute(frame)
    is_surface = drawn.target("position")[..., 3] > 0.0
    residual = drawn.target("sample_residual")
    expected = np.where(is_surface[..., None], residuals, 0.0)
    assert residual == pytest.approx(expected, rel=2e-3)
    assert drawn.target("sample_headroom")[..., 0] == pytest.approx(np.abs(expected[..., 3]), rel=2e-3)


def test_the_world_is_the_background(device):
    drawn = draw(device, lit_floor(), look_at((0.0, -4.0, 3.0)))
    is_background = drawn.target("position")[..., 3] == 0.0
    assert drawn.color[is_background] == pytest.approx(np.tile([0.3, 0.3, 0.3, 1.0], (is_background.sum(), 1)))


def test_a_transparent_film_has_an_empty_background(device):
    view = look_at((0.0, -4.0, 3.0))
    drawn = draw(device, lit_floor(), replace(view, transparent=True))
    opaque = draw(device, lit_floor(), view)
    is_background = drawn.target("position")[..., 3] == 0.0
    assert not drawn.color[is_background].any()
    assert np.array_equal(drawn.color[~is_background], opaque.color[~is_background])


def red_with_occlusion(device, scene, view, occlusion: np.ndarray) -> np.ndarray:
    """(H,W) red of the picture with this ambient occlusion (H/2,W/2)."""
    settings = replace(SMALL_SETTINGS, ssao=SSAO())
    drawn = draw(device, scene, view, settings)
    write_texels(drawn.renderer.graph[AMBIENT_OCCLUSION], occlusion.astype(np.float16))
    frame = drawn.renderer.frame(scene, view, settings, 0, Profile())
    drawn.renderer.graph.instance(Shade).execute(frame)
    return drawn.target("sample_color")[..., 0]


def test_occlusion_is_interpolated_on_a_plane(device):
    """A ramp at half resolution is a ramp at full resolution."""
    scene = make_scene([quad((-10, -10, 0), (20, 0, 0), (0, 20, 0))], world=1.0, base_color=(1, 1, 1))
    ramp = np.tile(np.arange(24) / 24.0, (24, 1))
    red = red_with_occlusion(device, scene, view_from_above(4.0, (48, 48)), ramp)
    assert red[:, :46] == pytest.approx(np.tile(np.arange(46) / 48.0, (48, 1)), abs=2e-3)


def test_occlusion_does_not_bleed_over_edges(device):
    """A black raised plate on a white floor, also where a half-resolution pixel shows the other surface."""
    floor, plate = quad((-10, -10, 0), (20, 0, 0), (0, 20, 0)), quad((-10, -10, 1), (10 + 1 / 24, 0, 0), (0, 20, 0))
    scene = make_scene([floor, plate], world=1.0, base_color=(1, 1, 1))
    view = view_from_above(4.0, (48, 48))
    on_plate = draw(device, scene, view).target("position")[..., 2] > 0.5
    red = red_with_occlusion(device, scene, view, np.where(on_plate[::2, ::2], 0.0, 1.0))
    assert red == pytest.approx(np.where(on_plate, 0.0, 1.0), abs=2e-3)


@pytest.mark.parametrize("size", [(1, 1), (2, 1), (1, 5), (7, 3)])
def test_odd_sizes(device, size):
    scene = make_scene([quad((-10, -10, 0), (20, 0, 0), (0, 20, 0))], world=1.0)
    color = draw(device, scene, view_from_above(4.0, size), replace(SMALL_SETTINGS, ssao=SSAO())).color
    assert color[..., :3] == pytest.approx(0.6, abs=1e-3)
