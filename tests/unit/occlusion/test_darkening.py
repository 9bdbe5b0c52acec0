# SPDX-License-Identifier: GPL-3.0-or-later
"""Which light ambient occlusion darkens, and the render pass AO."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.choices import OccludedLight, OcclusionSampling
from ism_addon.gpu.renderer import Renderer
from ism_addon.render_passes import COMBINED, OCCLUSION
from ism_addon.resources.world import SUM_OCCLUSION, WORLD_PREDICTION
from ism_addon.scene import World
from ism_addon.settings import SSAO, Shadow
from tests.support.small_scenes import SMALL_SETTINGS, SMALL_SHADOW_MAPS, draw, light, with_quality

from .test_ambient_occlusion import HEMISPHERE_SSAO, corner

UNSHADOWED, WORLD, ALL = OccludedLight
SAMPLINGS = list(OcclusionSampling)
TRACED_WORLD = replace(SMALL_SETTINGS, shadow=Shadow(world=True))
ALBEDO = 0.6


def settings(ssao: SSAO, base=SMALL_SETTINGS, samples: int = 2, **changes):
    return replace(with_quality(base, samples=samples), ssao=ssao, **changes)


def scene_with_a_lamp(world: float = 1.0):
    scene, view = corner()
    lamp = light(position=(0.0, -1.5, 3.0), radiance=3.0)
    return replace(scene, lights=lamp, world=World.even(np.full(3, world, np.float32))), view


def openness(device, scene, view, ssao: SSAO, samples: int = 2) -> np.ndarray:
    """(H,W): what ambient occlusion leaves, from a picture of an unshadowed world."""
    return draw(device, scene, view, settings(ssao, samples=samples)).color[..., 0] / ALBEDO


@pytest.mark.parametrize("sampling", SAMPLINGS, ids=str)
def test_it_can_darken_all_light(device, sampling):
    scene, view = scene_with_a_lamp()
    ssao = replace(HEMISPHERE_SSAO, sampling=sampling)
    left = openness(device, *corner(), ssao, 64)
    plain = draw(device, scene, view, settings(replace(ssao, enabled=False), samples=64)).color
    dark = draw(device, scene, view, settings(replace(ssao, light=ALL), samples=64)).color
    assert left.min() < 0.8
    assert dark[..., :3] == pytest.approx(plain[..., :3] * left[..., None], abs=0.05 * plain.max())
    assert np.sqrt(((dark - plain * left[..., None])[..., :3] ** 2).mean()) < 0.01 * plain.mean()


@pytest.mark.parametrize("sampling", SAMPLINGS, ids=str)
def test_it_can_darken_the_world_that_rays_are_traced_to(device, sampling):
    """By default it darkens no light whose shadows are traced."""
    scene, view = scene_with_a_lamp()
    ssao = replace(HEMISPHERE_SSAO, sampling=sampling)
    lamp_alone = replace(scene, world=World.even(np.zeros(3, np.float32)))
    left = openness(device, *corner(), ssao, 64)

    def color(scene, light):
        return draw(device, scene, view, settings(replace(ssao, light=light), TRACED_WORLD, 64)).color[..., :3]

    lamp, both, dark = color(lamp_alone, UNSHADOWED), color(scene, UNSHADOWED), color(scene, WORLD)
    expected = lamp + (both - lamp) * left[..., None]
    assert np.array_equal(lamp, color(lamp_alone, WORLD))
    assert abs(both - expected).max() > 0.05
    assert np.sqrt(((dark - expected) ** 2).mean()) < 0.012 * both.mean()


def test_what_the_default_does_not_darken_takes_no_pass(device):
    scene, view = scene_with_a_lamp()
    for base, world, light_, drawn_passes in (
        (TRACED_WORLD, 1.0, UNSHADOWED, 0),
        (TRACED_WORLD, 1.0, WORLD, 1),
        (SMALL_SETTINGS, 0.0, UNSHADOWED, 0),
        (SMALL_SETTINGS, 0.0, WORLD, 0),
        (SMALL_SETTINGS, 0.0, ALL, 1),
        (SMALL_SHADOW_MAPS, 1.0, UNSHADOWED, 1),
    ):
        lit = replace(scene, world=World.even(np.full(3, world, np.float32)))
        drawn = draw(device, lit, view, settings(replace(HEMISPHERE_SSAO, light=light_), base, 1))
        assert drawn.profile.rows["AmbientOcclusion"].drawn == drawn_passes
        separate = light_ is WORLD and world > 0.0
        assert (WORLD_PREDICTION in drawn.renderer.graph.targets.sizes) == separate


def test_the_other_choice_of_light_leaves_no_trace(device):
    scene, view = scene_with_a_lamp()
    choices = [
        settings(replace(HEMISPHERE_SSAO, light=light_), TRACED_WORLD) for light_ in (WORLD, UNSHADOWED, ALL, WORLD)
    ]
    renderer = Renderer(device)
    for chosen in (*choices, replace(choices[0], ssao=replace(choices[0].ssao, intensity=0.0))):
        again = draw(device, scene, view, chosen, renderer).color
        assert np.array_equal(again, draw(device, scene, view, chosen).color)


@pytest.mark.parametrize("sampling", SAMPLINGS, ids=str)
def test_the_tint_is_the_color_of_full_occlusion(device, sampling):
    scene, view = corner()
    ssao = replace(HEMISPHERE_SSAO, sampling=sampling, tint=(0.5, 0.2, 1.0))
    color = draw(device, scene, view, settings(ssao)).color[..., :3] / ALBEDO
    left = openness(device, scene, view, replace(ssao, tint=(0.0, 0.0, 0.0)))
    assert left.min() < 0.8
    expected = np.stack([tint + (1.0 - tint) * left for tint in ssao.tint], 2)
    assert color == pytest.approx(expected, abs=0.02)
    black = draw(device, scene, view, settings(replace(ssao, intensity=10.0), samples=1)).color[..., :3] / ALBEDO
    assert black.reshape(-1, 3).min(0) == pytest.approx(ssao.tint, abs=2e-3)


@pytest.mark.parametrize("sampling", SAMPLINGS, ids=str)
@pytest.mark.parametrize("filter_width", [0.01, 1.5, 6.0])
def test_the_render_pass_is_what_is_left_of_white_light(device, sampling, filter_width):
    scene, view = corner()
    view = replace(view, filter_width=filter_width)
    ssao = replace(HEMISPHERE_SSAO, sampling=sampling)
    drawn = draw(device, scene, view, settings(ssao, samples=8, occlusion_pass=True))
    images = drawn.renderer.images([COMBINED, OCCLUSION])
    assert images["AO"].shape == (view.height, view.width, 3)
    assert images["AO"] * ALBEDO == pytest.approx(images["Combined"][..., :3], abs=2e-3)


def test_the_render_pass_needs_no_light_and_changes_none(device):
    scene, view = scene_with_a_lamp(world=0.0)
    ssao = replace(HEMISPHERE_SSAO, enabled=False)
    plain = draw(device, scene, view, settings(ssao))
    drawn = draw(device, scene, view, settings(ssao, occlusion_pass=True))
    occlusion = drawn.renderer.images([OCCLUSION])["AO"]
    assert np.array_equal(plain.color, drawn.color)
    assert occlusion[..., 0] == pytest.approx(openness(device, *corner(), HEMISPHERE_SSAO), abs=2e-3)
    assert SUM_OCCLUSION not in plain.renderer.graph.targets.textures
    # Later pictures without it free its memory.
    draw(device, scene, view, settings(ssao), drawn.renderer)
    assert SUM_OCCLUSION not in drawn.renderer.graph.targets.textures


def test_the_render_pass_is_white_on_surfaces_without_a_radius_and_black_in_the_background(device):
    scene, view = corner()
    aside = replace(view, view_from_world=np.diag([1.0, 1.0, 1.0, 1.0]))
    unoccluded = settings(replace(HEMISPHERE_SSAO, radius=0.0), occlusion_pass=True)
    assert draw(device, scene, view, unoccluded).renderer.images([OCCLUSION])["AO"] == pytest.approx(1.0)
    away = settings(HEMISPHERE_SSAO, occlusion_pass=True)
    assert not draw(device, scene, aside, away).renderer.images([OCCLUSION])["AO"].any()
