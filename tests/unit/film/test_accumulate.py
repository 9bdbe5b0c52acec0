# SPDX-License-Identifier: GPL-3.0-or-later
"""The sums of samples, and how edges and penumbrae improve with more samples."""

import math
import time
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.passes.film.accumulate import RELATIVE_VARIANCE
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.resources import TILE_PROBABILITIES, TILE_SIZE, TILES
from ism_addon.sampling.pixel_grid import has_wide_filter
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

#: Luminance of the primaries of working spaces: of BT.709, and of AP1 of ACES (S-2014-004).
LUMINANCE = {"Linear Rec.709": (0.2126, 0.7152, 0.0722), "ACEScg": (0.2722287, 0.6740818, 0.0536895)}


def blackman_harris(t: np.ndarray) -> np.ndarray:
    """The filter's weight at t, from -1 to 1, and 0 beyond (Harris 1978)."""
    k = np.pi * (t + 1.0)
    weight = 0.35875 - 0.48829 * np.cos(k) + 0.14128 * np.cos(2 * k) - 0.01168 * np.cos(3 * k)
    return np.where(np.abs(t) < 1.0, weight, 0.0)


def filtered(values: np.ndarray, drawn, filter_radius: float, power: int = 1) -> np.ndarray:
    """Values (H,W,C) of a sample, added to all pixels with a weight, or a power of it.

    The weight is the filter's, times the probability of the pixel's tile, 0 if it has converged, over that of the
    sample's tile.
    """
    probabilities = read_texels(drawn.renderer.graph[TILE_PROBABILITIES], drawn.renderer.last[0].tiles)
    probabilities = probabilities.repeat(TILE_SIZE, 0).repeat(TILE_SIZE, 1)
    probability, own_probability = probabilities[..., :1], probabilities[..., 1:]
    subpixel_offsets = np.zeros((*drawn.drawn_tiles.shape, 2))
    tiles = drawn.renderer.graph[TILES]
    column, row = tiles["tile"].astype(int).T
    subpixel_offsets[row, column] = tiles["subpixel_offset"]
    height, width = values.shape[:2]
    offsets = subpixel_offsets.repeat(TILE_SIZE, 0).repeat(TILE_SIZE, 1)[:height, :width]
    if has_wide_filter(filter_radius):
        # All samples count as at the pixels' centres, and the filter is narrower by a pixel.
        offsets, filter_radius = np.zeros_like(offsets), math.sqrt(filter_radius**2 - RELATIVE_VARIANCE)
    is_drawn = drawn.drawn_tiles.repeat(TILE_SIZE, 0).repeat(TILE_SIZE, 1)[..., None]
    total, margin = np.zeros(values.shape), math.ceil(filter_radius + 0.5)
    for y in range(-margin, margin + 1):
        for x in range(-margin, margin + 1):
            weight = blackman_harris((offsets + (x, y)) / filter_radius).prod(-1, keepdims=True) ** power
            source = np.s_[max(y, 0) : height + min(y, 0), max(x, 0) : width + min(x, 0)]
            target = np.s_[max(-y, 0) : height - max(y, 0), max(-x, 0) : width - max(x, 0)]
            ratio = own_probability[target] / probability[source]
            total[target] += (is_drawn * weight * values)[source] * ratio**power
    return total


@pytest.mark.parametrize(
    ("filter_radius", "threshold", "space"),
    [(1.5, 0.0, "Linear Rec.709"), (1.5, 0.01, "ACEScg"), (5.0, 0.005, "ACEScg")],
)
def test_the_sums_are_of_the_samples_that_drew_a_tile(device, filter_radius, threshold, space):
    """With shadow rays: predictions, residuals, and the weights of both. Converged tiles have no more samples.

    The first sample is added again before the second, with residuals.
    """
    scene, view = box_over_plane(48, 32)
    blue = replace(scene.lights, emission=scene.lights.emission * np.float32([0.1, 0.5, 1.0]))
    scene, view = replace(scene, lights=blue, working_space=space), replace(view, filter_width=filter_radius)
    settings = with_quality(SMALL_SETTINGS, samples=64, error_threshold=threshold)
    sums = {name: np.zeros((32, 48, 4)) for name in ("sum_color", "sum_residual", "sum_weights")}
    sums["sum_headroom"] = np.zeros((32, 48, 1))
    ones = np.ones((32, 48, 1))
    renderer, profile = Renderer(device), Profile()
    list(renderer.sample(scene, view, settings, 0, profile))
    drawn = Drawn(renderer, profile, 1)
    assert not drawn.target("sum_residual").any()
    last = 19 if filter_radius < 2.0 else 17
    steps = (step for sample in range(1, last + 1) for step in renderer.sample(scene, view, settings, sample, profile))
    for _ in (step for step in steps if step == "Accumulate"):
        color, residual = drawn.target("sample_color"), drawn.target("sample_residual")
        luminance = ((color + residual)[..., :3] @ LUMINANCE[space])[..., None]
        square = (residual[..., :3] ** 2 @ LUMINANCE[space])[..., None]
        weights = np.concatenate([luminance**2, ones, np.sqrt(square), residual[..., 3:]], 2)
        values = np.concatenate([color, weights, drawn.target("sample_headroom"), residual[..., :3]], 2)
        colors, weights, headroom, residuals = np.split(filtered(values, drawn, filter_radius), (4, 8, 9), 2)
        sums["sum_color"] += colors
        sums["sum_weights"] += weights
        sums["sum_headroom"] += headroom
        sums["sum_residual"][..., :3] += residuals
        sums["sum_residual"][..., 3:] += filtered(square, drawn, filter_radius, power=2)
    assert not drawn.drawn_tiles.all(), "the last sample drew all tiles"
    assert drawn.renderer.error.converged.any() == (threshold > 0.0)
    assert not drawn.renderer.error.converged.all()
    for name, expected in sums.items():
        assert (np.abs(drawn.target(name) - expected) <= 1e-4 * np.maximum(np.abs(expected), 1.0)).all(), name
    alpha = drawn.color[..., 3]
    assert alpha == pytest.approx(sums["sum_color"][..., 3] / sums["sum_weights"][..., 1], abs=1e-5)


def filtered_edge(distance: np.ndarray, filter_radius: float) -> np.ndarray:
    """Fraction of the Blackman-Harris filter of this radius, px, less than `distance` px to the right of its centre."""
    t = np.linspace(-1.0, 1.0, 4001)
    cumulative = np.cumsum(blackman_harris(t))
    return np.interp(distance / filter_radius, t, cumulative / cumulative[-1])


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
    assert errors[2] < 0.01, "tiles drawn more often outweigh others along their borders"


@pytest.mark.parametrize("filter_radius", [4.4, 5.0, 10.0, 30.0])
def test_edges_are_as_smooth_as_wide_filters(device, filter_radius):
    """The same edge, in the middle of a picture that is wider than the filter."""
    width = 4 * math.ceil(filter_radius)
    plate = quad((-50.0, -50.0, 0.0), (50.0 - 0.7 / 16.0, 0.0, 0.0), (0.0, 100.0, 0.0))
    view = view_from_above(width / 16.0, (width, 4), filter_width=filter_radius, transparent=True)
    drawn = draw(device, make_scene([plate], world=1.0), view, with_quality(SMALL_SETTINGS, samples=64))
    inside = slice(width // 4, -width // 4)
    truth = filtered_edge(width / 2 - 0.7 - (np.arange(width) + 0.5), filter_radius)
    assert np.abs(drawn.color[:, inside, 3] - truth[inside]).max() < 0.006


def test_the_widest_filter_is_fast(device):
    """It would take a hundred times as long as a usual one if each pixel fetched all pixels within its radius."""
    scene, view = box_over_plane(160, 90)
    seconds = {1.5: math.inf, WIDEST_FILTER: math.inf}
    for _ in range(3):  # the first time, shaders are compiled
        for filter_radius, fastest in seconds.items():
            start = time.monotonic()
            draw(device, scene, replace(view, filter_width=filter_radius), with_quality(SMALL_SETTINGS, samples=3))
            seconds[filter_radius] = min(fastest, time.monotonic() - start)
    assert seconds[WIDEST_FILTER] < 10.0 * seconds[1.5]


def test_penumbrae_improve_with_every_sample(device):
    """With few virtual lights, more samples reduce the error, down to that of the shadow maps themselves."""
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


def test_a_new_picture_keeps_no_earlier_samples(device):
    scene, view = make_scene([random_triangles()], world=1.0), look_at((3.0, -3.0, 2.0))
    first = draw(device, scene, view, with_quality(SMALL_SETTINGS, samples=3))
    second = draw(device, scene, view, with_quality(SMALL_SETTINGS, samples=2), first.renderer)
    assert np.array_equal(second.color, draw(device, scene, view, with_quality(SMALL_SETTINGS, samples=2)).color)
