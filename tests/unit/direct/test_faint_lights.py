# SPDX-License-Identifier: GPL-3.0-or-later
"""Faint lights have their turns: as often as they are bright, and count the more the rarer they are."""

from collections import Counter
from dataclasses import fields, replace

import numpy as np
import pytest

from ism_addon.gpu.passes.direct import select_faint_lights
from ism_addon.gpu.passes.direct.trace_shadows import TraceShadows
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.resources import TILES
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import SMALL_SETTINGS, draw, with_quality

SIZE = 96, 64
SAMPLES = 32


def faint(part: float):
    """A box over a plane under a lamp, and another one of `part` of its light."""
    scene, view = box_over_plane(*SIZE)
    lights = scene.lights
    both = type(lights)(**{field.name: np.repeat(getattr(lights, field.name), 2, 0) for field in fields(lights)})
    radiance = both.radiance * np.array([[1.0], [part]], np.float32)
    return replace(scene, lights=replace(both, radiance=radiance)), view


def turns(device, part: float) -> tuple[dict, dict]:
    """By block: how often the faint lamp had a turn after the first sample, and how often it might have had one."""
    scene, view = faint(part)
    settings = with_quality(replace(SMALL_SETTINGS, shortcuts=True), samples=SAMPLES)
    renderer, had, took_part = Renderer(device), Counter(), Counter()
    for sample in range(SAMPLES):
        list(renderer.sample(scene, view, settings, sample, Profile()))
        if sample > 0:
            frame, _ = renderer.last
            had.update(map(tuple, renderer.graph.instance(TraceShadows).faint_tiles(frame)["tile"]))
            took_part.update(map(tuple, frame[TILES]["tile"]))
    return had, took_part


def test_the_fainter_a_light_is_the_rarer_is_its_turn(device):
    (brighter, could), (fainter, could_too) = turns(device, 0.002), turns(device, 0.001)
    both = brighter.keys() & fainter.keys()
    often, rarely = (sum(had[block] for block in both) for had in (brighter, fainter))
    assert len(both) > 10
    assert 0.4 < rarely / sum(could_too[block] for block in both) / (often / sum(could[block] for block in both)) < 0.7
    for block in both:
        assert select_faint_lights.MIN_LIGHT_PROBABILITY * could_too[block] - 2 < fainter[block] <= could_too[block]


def test_what_it_adds_is_the_same_on_average(device, monkeypatch):
    settings = with_quality(SMALL_SETTINGS, samples=SAMPLES)
    rarely = draw(device, *faint(0.002), settings)
    monkeypatch.setattr(select_faint_lights, "MIN_LIGHT_PROBABILITY", 1.0)
    always = draw(device, *faint(0.002), settings)
    without, exactly = (
        draw(device, *stage, replace(settings, shortcuts=False)).color[..., 0].sum(dtype=np.float64)
        for stage in (box_over_plane(*SIZE), faint(0.002))
    )
    assert rarely.profile.counts["pairs_traced"] < always.profile.counts["pairs_traced"]
    for drawn in (rarely, always):
        assert drawn.color[..., 0].sum(dtype=np.float64) - without == pytest.approx(exactly - without, rel=0.1)
