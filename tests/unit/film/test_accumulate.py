# SPDX-License-Identifier: GPL-3.0-or-later
"""More samples mean a better picture: edges and penumbrae."""

import math
import time
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.passes.film.accumulate import RELATIVE_VARIANCE, WIDE_MARGIN, filter_margin
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.resources import TILE_PROBABILITIES, TILE_SIZE, TILES
from ism_addon.setting_limits import WIDEST_FILTER
from tests.scenes.small import box_over_plane
from tests.support import reference
from tests.support.small_scenes import (
    SMALL_SETTINGS,
    SMALL_SHADOW_MAPS,
    Drawn,
    draw,
    look_at,
    make_scene,
    quad,
    random_triangles,
    read_texels,
    view_from_above,
    with_quality,
)

#: Of working spaces' primaries: BT.709's, and AP1's of ACES (S-2014-004).
LUMINANCE = {"Linear Rec.709": (0.2126, 0.7152, 0.0722), "ACEScg": (0.2722287, 0.6740818, 0.0536895)}


def blackman_harris(t: np.ndarray) -> np.ndarray:
    """The filter's weight at t, from -1 to 1 and nothing beyond (Harris 1978)."""
    k = np.pi * (t + 1.0)
    weight = 0.35875 - 0.48829 * np.cos(k) + 0.14128 * np.cos(2 * k) - 0.01168 * np.cos(3 * k)
    return np.where(np.abs(t) < 1.0, weight, 0.0)


def spread(values: np.ndarray, drawn, reach: float, power: int = 1) -> np.ndarray:
    """Values (H,W,C) of a sample, added to all pixels by the filter's weight, or a power of it.

    And by the chance of the pixel's block, 0 if it is settled, over that of the sample's.
    """
    chances = read_texels(drawn.renderer.graph[TILE_PROBABILITIES], drawn.renderer.last[0].tiles)
    chances = chances.repeat(TILE_SIZE, 0).repeat(TILE_SIZE, 1)
    chance, own_chance = chances[..., :1], chances[..., 1:]
    place = np.zeros((*drawn.drawn_tiles.shape, 2))
    blocks = drawn.renderer.graph[TILES]
    column, row = blocks["tile"].astype(int).T
    place[row, column] = blocks["subpixel_offset"]
    height, width = values.shape[:2]
    pixels = place.repeat(TILE_SIZE, 0).repeat(TILE_SIZE, 1)[:height, :width]
    if filter_margin(reach) >= WIDE_MARGIN:  # all count as at the centres, and the filter is narrower by a pixel
        pixels, reach = np.zeros_like(pixels), math.sqrt(reach**2 - RELATIVE_VARIANCE)
    part = drawn.drawn_tiles.repeat(TILE_SIZE, 0).repeat(TILE_SIZE, 1)[..., None]
    total, most = np.zeros(values.shape), math.ceil(reach + 0.5)
    for y in range(-most, most + 1):
        for x in range(-most, most + 1):
            weight = blackman_harris((pixels + (x, y)) / reach).prod(-1, keepdims=True) ** power
            there = np.s_[max(y, 0) : height + min(y, 0), max(x, 0) : width + min(x, 0)]
            here = np.s_[max(-y, 0) : height - max(y, 0), max(-x, 0) : width - max(x, 0)]
            total[here] += (part * weight * values)[there] * (own_chance[here] / chance[there]) ** power
    return total


@pytest.mark.parametrize(
    ("reach", "threshold", "space"),
    [(1.5, 0.0, "Linear Rec.709"), (1.5, 0.01, "ACEScg"), (5.0, 0.005, "ACEScg")],
)
def test_the_sums_are_of_the_samples_that_a_block_took_part_in(device, reach, threshold, space):
    """By rays: what was predicted, what corrects it, and the weights of both. Settled blocks have no more of them."""
    scene, view = box_over_plane(48, 32)
    blue = replace(scene.lights, radiance=scene.lights.radiance * np.float32([0.1, 0.5, 1.0]))
    scene, view = replace(scene, lights=blue, working_space=space), replace(view, filter_width=reach)
    settings = with_quality(SMALL_SETTINGS, samples=64, error_threshold=threshold)
    sums = {name: np.zeros((32, 48, 4)) for name in ("sum_color", "sum_residual", "sum_weights")}
    sums["sum_headroom"] = np.zeros((32, 48, 1))
    ones = np.ones((32, 48, 1))
    renderer, profile = Renderer(device), Profile()
    for sample in range(20 if reach < 2.0 else 18):
        list(renderer.sample(scene, view, settings, sample, profile))
        drawn = Drawn(renderer, profile, sample + 1)
        color, correction = drawn.target("sample_color"), drawn.target("sample_residual")
        bright = ((color + correction)[..., :3] @ LUMINANCE[space])[..., None]
        amounts = (correction[..., :3] @ LUMINANCE[space])[..., None]
        weights = np.concatenate([bright**2, ones, np.abs(amounts), correction[..., 3:]], 2)
        values = np.concatenate([color, weights, drawn.target("sample_headroom"), correction[..., :3]], 2)
        colors, weights, headroom, residuals = np.split(spread(values, drawn, reach), (4, 8, 9), 2)
        sums["sum_color"] += colors
        sums["sum_weights"] += weights
        sums["sum_headroom"] += headroom
        sums["sum_residual"][..., :3] += residuals
        sums["sum_residual"][..., 3:] += spread(amounts**2, drawn, reach, power=2)
    assert not drawn.drawn_tiles.all(), "no block was left out of the last sample"
    assert drawn.renderer.error.converged.any() == (threshold > 0.0)
    assert not drawn.renderer.error.converged.all()
    for name, expected in sums.items():
        assert (np.abs(drawn.target(name) - expected) <= 1e-4 * np.maximum(np.abs(expected), 1.0)).all(), name
    settled = drawn.color[..., 3]
    assert settled == pytest.approx(sums["sum_color"][..., 3] / sums["sum_weights"][..., 1], abs=1e-5)


def filtered_edge(distance: np.ndarray, reach: float) -> np.ndarray:
    """Part of the Blackman-Harris filter of `reach` px that lies less than `distance` px to the right of its middle."""
    t = np.linspace(-1.0, 1.0, 4001)
    cumulative = np.cumsum(blackman_harris(t))
    return np.interp(distance / reach, t, cumulative / cumulative[-1])


def test_edges_become_as_smooth_as_the_filter(device):
    """A plate that ends at 15.3 px, seen from straight above."""
    plate = quad((-50.0, -50.0, 0.0), (50.0 - 0.7 / 16.0, 0.0, 0.0), (0.0, 100.0, 0.0))
    view = view_from_above(2.0, (32, 4), filter_width=1.5, transparent=True)
    truth = filtered_edge(15.3 - (np.arange(32) + 0.5), 1.5)
    errors = []
    for samples in (1, 8, 64):
        alpha = draw(device, make_scene([plate], world=1.0), view, with_quality(SMALL_SETTINGS, samples=samples)).color[
            ..., 3
        ]
        errors.append(np.abs(alpha - truth).max())
    assert errors[0] > 0.15
    assert errors[1] < 0.09
    assert errors[2] < 0.01, "blocks drawn more often do not outweigh others along their borders"


@pytest.mark.parametrize("reach", [4.4, 5.0, 10.0, 30.0])
def test_edges_are_as_smooth_as_wide_filters(device, reach):
    """The same edge, in the middle of a picture that is wider than the filter."""
    width = 4 * math.ceil(reach)
    plate = quad((-50.0, -50.0, 0.0), (50.0 - 0.7 / 16.0, 0.0, 0.0), (0.0, 100.0, 0.0))
    view = view_from_above(width / 16.0, (width, 4), filter_width=reach, transparent=True)
    drawn = draw(device, make_scene([plate], world=1.0), view, with_quality(SMALL_SETTINGS, samples=64))
    inside = slice(width // 4, -width // 4)
    truth = filtered_edge(width / 2 - 0.7 - (np.arange(width) + 0.5), reach)
    assert np.abs(drawn.color[:, inside, 3] - truth[inside]).max() < 0.006


def test_the_widest_filter_is_drawn_soon(device):
    """It would take a hundred times as long as a usual one if each pixel looked at all that it reaches."""
    scene, view = box_over_plane(160, 90)
    seconds = {1.5: math.inf, WIDEST_FILTER: math.inf}
    for _ in range(3):  # the first time, shaders are compiled
        for reach, least in seconds.items():
            began = time.monotonic()
            draw(device, scene, replace(view, filter_width=reach), with_quality(SMALL_SETTINGS, samples=3))
            seconds[reach] = min(least, time.monotonic() - began)
    assert seconds[WIDEST_FILTER] < 10.0 * seconds[1.5]


def test_every_sample_adds_to_the_penumbra(device):
    """With few virtual lights the error falls as samples are added, to what the shadow maps themselves leave."""
    scene, view = box_over_plane(36, 24)
    truth, _ = reference.picture(scene, view, 10)
    errors = []
    for samples in (1, 4, 24):
        settings = with_quality(SMALL_SHADOW_MAPS, samples=samples, virtual_lights=3, map_size=96, map_points=16384)
        color = draw(device, scene, view, settings).color[..., :3].reshape(-1, 3)
        errors.append(reference.nrmse(color, truth))
    assert errors[1] < 0.8 * errors[0]
    assert errors[2] < 0.8 * errors[1]
    assert errors[2] < 0.04


def test_a_new_picture_starts_from_nothing(device):
    scene, view = make_scene([random_triangles()], world=1.0), look_at((3.0, -3.0, 2.0))
    first = draw(device, scene, view, with_quality(SMALL_SETTINGS, samples=3))
    second = draw(device, scene, view, with_quality(SMALL_SETTINGS, samples=2), first.renderer)
    assert np.array_equal(second.color, draw(device, scene, view, with_quality(SMALL_SETTINGS, samples=2)).color)
