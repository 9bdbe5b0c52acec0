# SPDX-License-Identifier: GPL-3.0-or-later
"""Faint lights are drawn with a probability in proportion to their light, and weighted by its inverse."""

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


def scene_with_faint_light(fraction: float):
    """A box over a plane under a light, and a second light at the same position with this fraction of its radiance."""
    scene, view = box_over_plane(*SIZE)
    lights = scene.lights
    both = type(lights)(**{field.name: np.repeat(getattr(lights, field.name), 2, 0) for field in fields(lights)})
    emission = both.emission * np.array([[1.0], [fraction]], np.float32)
    return replace(scene, lights=replace(both, emission=emission)), view


def draw_counts(device, fraction: float) -> tuple[dict, dict]:
    """By tile: the samples after the first that drew the faint light, and those that drew the tile."""
    scene, view = scene_with_faint_light(fraction)
    settings = with_quality(replace(SMALL_SETTINGS, shortcuts=True), samples=SAMPLES)
    renderer, light_drawn, tile_drawn = Renderer(device), Counter(), Counter()
    for sample in range(SAMPLES):
        list(renderer.sample(scene, view, settings, sample, Profile()))
        if sample > 0:
            frame, _ = renderer.last
            light_drawn.update(map(tuple, renderer.graph.instance(TraceShadows).faint_tiles(frame)["tile"]))
            tile_drawn.update(map(tuple, frame[TILES]["tile"]))
    return light_drawn, tile_drawn


def test_a_fainter_light_is_drawn_less_often(device):
    (brighter, brighter_all), (fainter, fainter_all) = draw_counts(device, 0.002), draw_counts(device, 0.001)
    both = brighter.keys() & fainter.keys()
    often, rarely = (sum(counts[tile] for tile in both) for counts in (brighter, fainter))
    assert len(both) > 10
    ratio = rarely / sum(fainter_all[tile] for tile in both) / (often / sum(brighter_all[tile] for tile in both))
    assert 0.4 < ratio < 0.7
    for tile in both:
        assert select_faint_lights.MIN_LIGHT_PROBABILITY * fainter_all[tile] - 2 < fainter[tile] <= fainter_all[tile]


def test_a_faint_light_adds_the_same_light_on_average(device, monkeypatch):
    settings = with_quality(SMALL_SETTINGS, samples=SAMPLES)
    rarely = draw(device, *scene_with_faint_light(0.002), settings)
    monkeypatch.setattr(select_faint_lights, "MIN_LIGHT_PROBABILITY", 1.0)
    always = draw(device, *scene_with_faint_light(0.002), settings)
    base, exact = (
        draw(device, *scene_and_view, replace(settings, shortcuts=False)).color[..., 0].sum(dtype=np.float64)
        for scene_and_view in (box_over_plane(*SIZE), scene_with_faint_light(0.002))
    )
    assert rarely.profile.counts["pairs_traced"] < always.profile.counts["pairs_traced"]
    for drawn in (rarely, always):
        assert drawn.color[..., 0].sum(dtype=np.float64) - base == pytest.approx(exact - base, rel=0.1)
