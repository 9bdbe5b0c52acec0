# SPDX-License-Identifier: GPL-3.0-or-later
"""Ambient occlusion in a viewport does not flicker while the view turns, or while a light moves."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.choices import OcclusionSampling
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.render_passes import OCCLUSION
from ism_addon.resources import POSITION
from ism_addon.resources.world import STEADY_OCCLUSION
from ism_addon.scene import View, World
from ism_addon.settings import SSAO
from tests.support.small_scenes import SMALL_SETTINGS, draw, light, look_at, with_quality

from .test_ambient_occlusion import HEMISPHERE_SSAO, boxes_on_a_floor

SIZE = (160, 120)
#: Degrees from view to view, as in a slow orbit.
STEP = 0.5
VIEWS = 18


def orbit(step: int) -> View:
    angle = math.radians(STEP * step) - 1.0
    return look_at((4.7 * math.cos(angle), 4.7 * math.sin(angle), 3.0), (0.2, 0.0, 0.2), SIZE, math.radians(40.0))


def settings(ssao: SSAO):
    return replace(with_quality(SMALL_SETTINGS, samples=1), ssao=ssao, occlusion_pass=True)


def first_sample(renderer: Renderer, scene, view: View, chosen, low_latency: bool = True) -> np.ndarray:
    """(H,W): what ambient occlusion leaves, in a first sample."""
    for _ in renderer.sample(scene, view, chosen, 0, Profile(), low_latency=low_latency):
        pass
    return renderer.images([OCCLUSION])["AO"][..., 0]


def change(before: np.ndarray, after: np.ndarray, positions: np.ndarray, seen: np.ndarray, view: View) -> np.ndarray:
    """Differences between two pictures at the points (H,W,3) that the second shows at its pixels and the first, of
    `view` and with points `seen` (H,W,3), shows too."""
    clip = (
        np.concatenate([positions, np.ones_like(positions[..., :1])], 2)
        @ (view.clip_from_view @ view.view_from_world).T
    )
    x, y = ((0.5 * clip[..., k] / clip[..., 3] + 0.5) * (view.width, view.height)[k] - 0.5 for k in (0, 1))
    column, row = np.floor(x).astype(int), np.floor(y).astype(int)
    inside = (column >= 0) & (row >= 0) & (column < view.width - 1) & (row < view.height - 1)
    column, row = np.clip(column, 0, view.width - 2), np.clip(row, 0, view.height - 2)
    total = np.zeros(positions.shape[:2])
    for dy, dx in ((0, 0), (0, 1), (1, 0), (1, 1)):
        weight = (1 - abs(x - column - dx)) * (1 - abs(y - row - dy))
        total += weight * before[row + dy, column + dx]
        inside &= np.linalg.norm(seen[row + dy, column + dx] - positions, axis=2) < 0.01 * clip[..., 3]
    return (after - total)[inside]


def flicker(device, ssao: SSAO, low_latency: bool) -> float:
    """RMS change from the last view but one to the last of an orbit, of surfaces that both show."""
    scene, _, _ = boxes_on_a_floor()
    renderer, pictures = Renderer(device), []
    for step in range(VIEWS):
        left = first_sample(renderer, scene, orbit(step), settings(ssao), low_latency)
        anchor = renderer.last[0].anchor
        pictures.append((left, renderer.graph.targets.read(POSITION)[..., :3] + anchor))
    (before, seen), (after, positions) = pictures[-2:]
    return float(np.sqrt((change(before, after, positions, seen, orbit(VIEWS - 2)) ** 2).mean()))


@pytest.mark.parametrize("sampling", OcclusionSampling, ids=str)
def test_it_is_steady_while_the_view_turns(device, sampling):
    ssao = SSAO(sampling=sampling)
    steady, plain = (flicker(device, ssao, low_latency) for low_latency in (True, False))
    assert steady < 1.0 / 255.0
    assert steady < 0.8 * plain


@pytest.mark.parametrize("sampling", OcclusionSampling, ids=str)
def test_it_does_not_change_while_a_light_moves(device, sampling):
    scene, _, _ = boxes_on_a_floor()
    renderer, chosen = Renderer(device), settings(SSAO(sampling=sampling))
    for step in range(3):
        before = first_sample(renderer, scene, orbit(step), chosen)
    for height in (2.0, 2.1, 2.2):
        lit = replace(scene, lights=light(position=(0.0, -1.0, height)))
        assert np.array_equal(first_sample(renderer, lit, orbit(2), chosen), before)


def test_it_is_as_without_other_views_where_these_say_nothing(device):
    scene, _, _ = boxes_on_a_floor()
    chosen, renderer = settings(HEMISPHERE_SSAO), Renderer(device)
    fresh = first_sample(Renderer(device), scene, orbit(0), chosen, low_latency=False)
    assert first_sample(renderer, scene, orbit(0), chosen) == pytest.approx(fresh, abs=1e-3)
    first_sample(renderer, scene, orbit(360), chosen)  # from the other side
    # A scene that has changed, and another radius.
    matrices = scene.instances.world_from_object.copy()
    matrices[1, 2, 3] += 0.3
    moved = replace(scene, instances=replace(scene.instances, world_from_object=matrices))
    wide = settings(replace(HEMISPHERE_SSAO, radius=0.9))
    for changed, other in ((moved, chosen), (scene, wide)):
        expected = first_sample(Renderer(device), changed, orbit(1), other, low_latency=False)
        assert first_sample(renderer, changed, orbit(1), other) == pytest.approx(expected, abs=1e-3)


def test_another_intensity_keeps_it(device):
    scene, _, _ = boxes_on_a_floor()
    renderer = Renderer(device)
    left = [first_sample(renderer, scene, orbit(step), settings(HEMISPHERE_SSAO)) for step in range(3)][-1]
    half = first_sample(renderer, scene, orbit(2), settings(replace(HEMISPHERE_SSAO, intensity=0.5)))
    seen = left > 0.0  # not the background
    assert 1.0 - half[seen] == pytest.approx(0.5 * (1.0 - left[seen]), abs=1e-3)


@pytest.mark.parametrize("sampling", OcclusionSampling, ids=str)
def test_samples_after_the_first_picture_are_as_in_final_renders(device, sampling):
    scene, _, _ = boxes_on_a_floor()
    chosen, left = with_quality(settings(SSAO(sampling=sampling)), samples=32), []
    for low_latency in (True, False):
        renderer = Renderer(device)
        for sample in range(32):
            for _ in renderer.sample(scene, orbit(0), chosen, sample, Profile(), low_latency=low_latency):
                pass
        left.append(renderer.images([OCCLUSION])["AO"][..., 0])
    assert np.sqrt(((left[0] - left[1]) ** 2).mean()) < 0.002


def test_final_renders_and_pictures_without_occlusion_have_no_such_pass(device):
    scene, _, _ = boxes_on_a_floor()
    drawn = draw(device, scene, orbit(0), settings(HEMISPHERE_SSAO))
    assert not drawn.profile.rows["SteadyOcclusion"].drawn
    renderer, dark = Renderer(device), replace(scene, world=World.even(np.zeros(3, np.float32)))
    chosen = replace(settings(HEMISPHERE_SSAO), occlusion_pass=False)
    for _ in renderer.sample(dark, orbit(0), chosen, 0, Profile(), low_latency=True):
        pass
    assert STEADY_OCCLUSION not in renderer.graph.targets.sizes
