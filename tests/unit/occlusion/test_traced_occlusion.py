# SPDX-License-Identifier: GPL-3.0-or-later
"""Ambient occlusion by rays: compared with a reference and closed forms, and which rays are traced again."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.choices import OcclusionSampling, RadiusUnit
from ism_addon.resources.world import OCCLUSION_DISTANCE
from ism_addon.settings import SSAO
from tests.scenes.worlds.closed_occlusion import CLOSED_FORMS
from tests.support import reference
from tests.support.small_scenes import SMALL_SETTINGS, SMALL_SHADOW_MAPS, draw, look_at, make_scene, quad, with_quality

from .test_ambient_occlusion import HEMISPHERE_SSAO, SETTINGS, boxes_on_a_floor, corner, inner_surface

TRACED = replace(HEMISPHERE_SSAO, sampling=OcclusionSampling.TRACED)
ALBEDO = 0.6


def settings(ssao: SSAO = TRACED, samples: int = 4, base=SMALL_SETTINGS):
    return replace(with_quality(base, samples=samples), ssao=ssao)


def openness(drawn) -> np.ndarray:
    """(H,W): what is left of the light of a world of radiance 1."""
    return drawn.color[..., 0].astype(float) / ALBEDO


@pytest.mark.parametrize("ssao", SETTINGS)
def test_converges_to_the_reference(device, ssao):
    scene, view, _ = boxes_on_a_floor()
    inner, *surface = inner_surface(scene, view)
    truth = reference.ray_traced_occlusion(*surface, ssao.radius, ssao.cone_angle, ssao.attenuation)
    chosen = settings(replace(ssao, sampling=OcclusionSampling.TRACED), 64)
    error = openness(draw(device, scene, view, chosen))[::2, ::2][inner] - truth
    assert abs(error.mean()) < 0.003
    assert np.sqrt((error**2).mean()) < 0.02


@pytest.mark.parametrize("name", CLOSED_FORMS)
@pytest.mark.parametrize(
    ("sampling", "bound"), [(OcclusionSampling.TRACED, 0.005), (OcclusionSampling.HORIZONS, 0.05)], ids=str
)
def test_closed_forms(device, name, sampling, bound):
    case = CLOSED_FORMS[name]()
    surface = reference.surfaces(case.scene, case.view)
    truth = case.open_at(surface.position, surface.geometric_normal).reshape(case.view.height, case.view.width)
    inside = np.isfinite(truth) & (surface.triangle >= 0).reshape(truth.shape)
    for axis in (0, 1):  # pixels with an edge have the light of both sides
        for step in (-1, 1):
            inside &= np.roll(inside, step, axis)
    drawn = draw(device, case.scene, case.view, settings(replace(case.ssao, sampling=sampling), 256))
    error = (openness(drawn) - truth)[inside]
    assert inside.sum() > 500 and truth[inside].min() < 0.9
    assert np.sqrt((error**2).mean()) < bound


@pytest.mark.parametrize("base", [SMALL_SETTINGS, SMALL_SHADOW_MAPS], ids=["rays", "maps"])
@pytest.mark.parametrize(
    "change", [{"radius": 0.2}, {"radius": 3.0}, {"intensity": 0.5}, {"attenuation": 3.0}], ids=str
)
def test_other_settings_trace_no_rays(device, base, change):
    """In later samples, other tiles may take part more often than before."""
    scene, view = corner()
    drawn = draw(device, scene, view, settings(samples=2, base=base))
    before = drawn.color
    assert drawn.profile.counts["occlusion_rays"] == 2 * view.width * view.height
    other = settings(replace(TRACED, **change), samples=2, base=base)
    again = draw(device, scene, view, other, drawn.renderer)
    assert again.profile.counts["occlusion_rays"] == 0
    assert np.array_equal(again.color, draw(device, scene, view, other).color)
    assert not np.array_equal(again.color, before)


def test_the_same_again_traces_no_rays(device):
    """With tiles that take part in different samples."""
    scene, view = corner()
    view = replace(view, filter_width=1.5)
    drawn = draw(device, scene, view, settings(samples=16))
    before = drawn.color
    assert drawn.profile.counts["occlusion_rays"] < 0.9 * 16 * view.width * view.height
    again = draw(device, scene, view, settings(samples=16), drawn.renderer)
    assert again.profile.counts["occlusion_rays"] == 0
    assert np.array_equal(again.color, before)


def test_another_cone_view_or_scene_traces_rays(device):
    scene, view = corner()
    matrices = scene.instances.world_from_object.copy()
    matrices[1, 1, 3] -= 0.2
    moved = replace(scene, instances=replace(scene.instances, world_from_object=matrices))
    turned = look_at((0.1, -4.0, 4.0), size=(view.width, view.height))
    narrow = settings(replace(TRACED, cone_angle=1.0))
    for other in ((moved, view, settings()), (scene, turned, settings()), (scene, view, narrow)):
        renderer = draw(device, scene, view, settings()).renderer
        again = draw(device, *other, renderer)
        assert again.profile.counts["occlusion_rays"] > 0
        assert np.array_equal(again.color, draw(device, *other).color)


def test_without_shortcuts_rays_are_traced_again(device):
    scene, view = corner()
    plain = replace(settings(), shortcuts=False)
    renderer = draw(device, scene, view, plain).renderer
    assert draw(device, scene, view, plain, renderer).profile.counts["occlusion_rays"] > 0


def test_surfaces_that_the_camera_does_not_see_occlude(device):
    """A ceiling behind the camera."""
    floor, ceiling = quad((-9, -9, 0), (18, 0, 0), (0, 18, 0)), quad((-9, -9, 1), (0, 18, 0), (18, 0, 0))
    view = look_at((0.0, 0.0, 0.8), (0.0, 0.01, 0.0), (16, 16), math.radians(60.0))
    scene = make_scene([floor, ceiling], world=1.0)
    near = openness(draw(device, scene, view, settings(replace(TRACED, radius=0.99))))
    # Directions whose cosine is at least 1/2 meet it within 2 m: three quarters of those weighted by the cosine.
    far = openness(draw(device, scene, view, settings(replace(TRACED, radius=2.0), 64)))
    assert near == pytest.approx(1.0)
    assert far.mean() == pytest.approx(0.25, abs=0.005)


def test_instances_without_shadows_do_not_occlude(device):
    scene, view = corner()
    free = replace(scene, instances=replace(scene.instances, casts_shadow=np.array([True, False])))
    drawn = draw(device, free, view, settings())
    floor = drawn.target("normal")[..., 2:].any(2)
    assert floor.any() and openness(drawn).max() == pytest.approx(1.0)
    none = replace(scene, instances=replace(scene.instances, casts_shadow=np.array([False, False])))
    drawn = draw(device, none, view, settings())
    assert drawn.profile.counts["occlusion_rays"] == 0 and openness(drawn) == pytest.approx(1.0)


def test_a_radius_in_pixels_is_the_same_in_the_picture(device):
    """Half as large and half as far away, all looks the same."""
    scene, view = corner()
    matrices = scene.instances.world_from_object.copy()
    matrices[:, :3] *= 0.5
    small = replace(scene, instances=replace(scene.instances, world_from_object=matrices))
    nearer = look_at((0.0, -2.0, 2.0), (0.0, 0.0, 0.0), (96, 96), math.radians(25.0))
    for sampling in OcclusionSampling:
        ssao = replace(HEMISPHERE_SSAO, sampling=sampling, unit=RadiusUnit.PIXELS, radius_pixels=20.0)
        one, other = (openness(draw(device, *each, settings(ssao))) for each in ((scene, view), (small, nearer)))
        assert one.min() < 0.85
        assert other == pytest.approx(one, abs=0.02)
    meters = openness(draw(device, small, nearer, settings()))
    assert abs(meters - openness(draw(device, scene, view, settings()))).max() > 0.1


@pytest.mark.parametrize(
    "off", [{"enabled": False}, {"intensity": 0.0}, {"radius": 0.0}, {"tint": (1.0, 1.0, 1.0)}], ids=str
)
def test_switched_off_nothing_is_traced_and_built(device, off):
    scene, view = corner()
    drawn = draw(device, scene, view, settings(replace(TRACED, **off), base=SMALL_SHADOW_MAPS))
    for name in ("TraceOcclusion", "FilterOcclusion", "BuildTLAS", "UploadBLAS"):
        assert drawn.profile.rows[name].drawn == 0, name
    assert OCCLUSION_DISTANCE not in drawn.renderer.graph.targets.textures
    assert openness(drawn) == pytest.approx(1.0)
