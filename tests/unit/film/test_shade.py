# SPDX-License-Identifier: GPL-3.0-or-later
"""Composition: linear light, the world behind everything, and occlusion brought to full resolution."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.passes.film.shade import Shade
from ism_addon.gpu.profile import Profile
from ism_addon.resources import AMBIENT_OCCLUSION, DIRECT_PREDICTION, DIRECT_RESIDUAL
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
    seen = drawn.target("position")[..., 3] > 0.0
    expected = drawn.target("direct_prediction")[..., :3] + np.array([0.8, 0.4, 0.1]) * 0.3
    assert 0 < seen.sum() < seen.size
    assert drawn.color[seen][:, :3] == pytest.approx(expected[seen], rel=2e-3)
    assert (drawn.color[seen][:, 3] == 1.0).all()
    assert np.ptp(drawn.target("direct_prediction")[seen]) > 0.1


def test_a_residual_is_handed_on_as_it_is(device):
    """And in its alpha the luminance that is in doubt; another target has that by which it may rise."""
    settings = with_quality(SMALL_SETTINGS, samples=2)
    drawn = draw(device, lit_floor(), look_at((0.0, -4.0, 3.0)), settings)
    corrections = np.random.default_rng(0).normal(size=(24, 32, 4))
    write_texels(drawn.renderer.graph[DIRECT_RESIDUAL], corrections.astype(np.float32))
    write_texels(drawn.renderer.graph[DIRECT_PREDICTION], np.abs(corrections).astype(np.float32))
    frame = drawn.renderer.frame(lit_floor(), look_at((0.0, -4.0, 3.0)), settings, 1, Profile())
    drawn.renderer.graph.instance(Shade).execute(frame)
    seen = drawn.target("position")[..., 3] > 0.0
    found = drawn.target("sample_residual")
    expected = np.where(seen[..., None], corrections, 0.0)
    assert found == pytest.approx(expected, rel=2e-3)
    assert drawn.target("sample_headroom")[..., 0] == pytest.approx(np.abs(expected[..., 3]), rel=2e-3)


def test_the_world_stands_behind(device):
    drawn = draw(device, lit_floor(), look_at((0.0, -4.0, 3.0)))
    behind = drawn.target("position")[..., 3] == 0.0
    assert drawn.color[behind] == pytest.approx(np.tile([0.3, 0.3, 0.3, 1.0], (behind.sum(), 1)))


def test_a_transparent_film_is_empty_behind(device):
    view = look_at((0.0, -4.0, 3.0))
    drawn = draw(device, lit_floor(), replace(view, transparent=True))
    opaque = draw(device, lit_floor(), view)
    behind = drawn.target("position")[..., 3] == 0.0
    assert not drawn.color[behind].any()
    assert np.array_equal(drawn.color[~behind], opaque.color[~behind])


def composed(device, scene, view, occlusion: np.ndarray) -> np.ndarray:
    """(H,W) red of the picture with (H/2,W/2) in the place of the smooth occlusion."""
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
    found = composed(device, scene, view_from_above(4.0, (48, 48)), ramp)
    assert found[:, :46] == pytest.approx(np.tile(np.arange(46) / 48.0, (48, 1)), abs=2e-3)


def test_occlusion_does_not_bleed_over_edges(device):
    """A raised plate on the left, black; the floor, white; also where a pixel's half-resolution one shows the other."""
    floor, plate = quad((-10, -10, 0), (20, 0, 0), (0, 20, 0)), quad((-10, -10, 1), (10 + 1 / 24, 0, 0), (0, 20, 0))
    scene = make_scene([floor, plate], world=1.0, base_color=(1, 1, 1))
    view = view_from_above(4.0, (48, 48))
    on_plate = draw(device, scene, view).target("position")[..., 2] > 0.5
    found = composed(device, scene, view, np.where(on_plate[::2, ::2], 0.0, 1.0))
    assert found == pytest.approx(np.where(on_plate, 0.0, 1.0), abs=2e-3)


@pytest.mark.parametrize("size", [(1, 1), (2, 1), (1, 5), (7, 3)])
def test_odd_sizes(device, size):
    scene = make_scene([quad((-10, -10, 0), (20, 0, 0), (0, 20, 0))], world=1.0)
    color = draw(device, scene, view_from_above(4.0, size), replace(SMALL_SETTINGS, ssao=SSAO())).color
    assert color[..., :3] == pytest.approx(0.6, abs=1e-3)
