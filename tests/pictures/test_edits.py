# SPDX-License-Identifier: GPL-3.0-or-later
"""An edit draws exactly those passes again that depend on it, after one sample or several."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.passes.light_selection.cull_lights import CullLights
from ism_addon.resources import REDISCOVERED, TILE_VISIBILITY
from ism_addon.settings import SSAO, Method
from tests.scenes.changes import EACH_SAMPLE, EDITS, FIRST, SHARED, colour_changed
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    SMALL_SHADOW_MAPS,
    draw,
    join_lights,
    light,
    look_at,
    make_scene,
    quad,
    with_quality,
)

SETTINGS = {
    Method.RAY_TRACED: replace(SMALL_SETTINGS, ssao=SSAO()),
    Method.SHADOW_MAPS: replace(SMALL_SHADOW_MAPS, ssao=SSAO()),
}
SIZE = 24, 16
SAMPLES = 6


@pytest.fixture(params=Method, ids=[method.label for method in Method])
def method(request):
    return request.param


def redrawn_passes(device, edit, settings, last=None):
    """The passes that an edit has drawn again up to sample `last`. The picture must be that of a new renderer."""
    scene, view = box_over_plane(*SIZE)
    first = draw(device, scene, view, settings)
    assert first.color.any()
    edited = edit(scene, view)
    again = draw(device, *edited, settings, first.renderer, last)
    fresh = draw(device, *edited, settings, last=last)
    assert np.array_equal(again.color, fresh.color), "a reused result was out of date"
    return {name for name, row in again.profile.rows.items() if row.drawn}


@pytest.mark.parametrize("edit", EDITS)
def test_after_one_sample(device, method, edit):
    assert redrawn_passes(device, edit, SETTINGS[method]) == SHARED[method][edit] | FIRST[method][edit]


@pytest.mark.parametrize("last", [0, SAMPLES - 1])
@pytest.mark.parametrize("edit", EDITS)
def test_after_several_samples(device, method, edit, last):
    settings = with_quality(SETTINGS[method], samples=SAMPLES)
    later = {"RetestOccluded", "MatchPredictions"} if last and method == Method.RAY_TRACED else set()
    assert redrawn_passes(device, edit, settings, last) == SHARED[method][edit] | EACH_SAMPLE[method] | later


def test_a_rediscovered_light_is_not_in_the_probe_results_of_the_next_picture(device, monkeypatch):
    """Later samples add rediscovered lights to the probe results, which the next picture may reuse without them."""
    monkeypatch.setattr(CullLights, "rediscovered", lambda _pass, frame: {0: np.ones(frame.tiles[::-1], bool)})
    lid = quad((-9.0, -9.0, 1.0), (18.0, 0.0, 0.0), (0.0, 18.0, 0.0))
    lights = join_lights(light(radiance=0.008), light(position=(0.0, 0.0, 0.9)))
    scene = make_scene([quad((-3.0, -3.0, 0.0), (6.0, 0.0, 0.0), (0.0, 6.0, 0.0)), lid], lights)
    settings, view = with_quality(SETTINGS[Method.RAY_TRACED], samples=SAMPLES), look_at((0.0, -4.0, 0.8), size=SIZE)
    first = draw(device, scene, view, settings)
    assert set(first.renderer.graph[TILE_VISIBILITY]) == {0, 1}
    again = draw(device, *colour_changed(scene, view), settings, first.renderer, last=0)
    assert set(again.renderer.graph[TILE_VISIBILITY]) == {1}
    assert not again.profile.rows["ProbeVisibility"].drawn


def test_rediscovered_lights_are_dropped_with_their_picture(device, method, monkeypatch):
    """The next picture has fewer lights, and may use the other method."""
    monkeypatch.setattr(CullLights, "rediscovered", lambda _pass, frame: {1: np.ones(frame.tiles[::-1], bool)})
    floor, view = quad((-3.0, -3.0, 0.0), (6.0, 0.0, 0.0), (0.0, 6.0, 0.0)), look_at((0.0, -4.0, 0.8), size=SIZE)
    before = make_scene([floor], join_lights(light(), light(position=(0.0, 0.0, 0.9))))
    renderer = draw(device, before, view, with_quality(SETTINGS[Method.RAY_TRACED], samples=SAMPLES)).renderer
    assert renderer.graph[REDISCOVERED]
    monkeypatch.undo()
    after, settings = make_scene([floor], light()), with_quality(SETTINGS[method], samples=3)
    expected = draw(device, after, view, settings).color
    assert np.array_equal(draw(device, after, view, settings, renderer).color, expected)


def test_after_many_edits_the_picture_is_that_of_a_new_renderer(device, method):
    """After random edits and pictures that were interrupted after a few passes."""
    from ism_addon.gpu.profile import Profile

    random = np.random.default_rng(1)
    scene, view = box_over_plane(*SIZE)
    states = [edit(scene, view) for edit in EDITS]
    expected: dict = {}
    renderer = draw(device, scene, view, SETTINGS[method]).renderer
    for _ in range(24):
        state, samples = random.integers(len(states)), int(random.integers(1, 4))
        settings = with_quality(SETTINGS[method], samples=samples)
        interrupted = renderer.sample(*states[random.integers(len(states))], settings, 0, Profile())
        for _ in range(random.integers(16)):
            next(interrupted, None)
        interrupted.close()
        if (state, samples) not in expected:
            expected[state, samples] = draw(device, *states[state], settings).color
        color = draw(device, *states[state], settings, renderer).color
        assert np.array_equal(color, expected[state, samples])
