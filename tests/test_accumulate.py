# SPDX-License-Identifier: GPL-3.0-or-later
"""More samples mean a better picture: edges and penumbrae."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.passes import BLOCK
from ism_addon.sampling import blackman_harris

from . import reference
from .scenes.small import box_over_plane
from .studio import MAPS, SMALL_SETTINGS, draw, from_above, look, quad, rubble, stage, with_quality

#: Rec. 709, as in lib/luminance.glsl.
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def test_the_picture_is_the_mean_of_its_samples(device):
    """By shadow maps, which have nothing to correct."""
    scene, view = box_over_plane(24, 16)
    view, settings = replace(view, filter_width=1.5), with_quality(MAPS, samples=5)
    apart = [draw(device, scene, view, settings, last=sample).target("color") for sample in range(5)]
    assert np.std(apart, axis=0).max() > 0.01
    assert draw(device, scene, view, settings).color == pytest.approx(np.mean(apart, axis=0), abs=1e-6)


def test_the_sums_are_of_the_samples_that_a_block_took_part_in(device):
    """By rays: what was predicted, what corrects it, and the squares of both together."""
    scene, view = box_over_plane(48, 32)
    settings = with_quality(SMALL_SETTINGS, samples=12)
    sums = {"sum": np.zeros((32, 48, 4)), "sum_correction": np.zeros((32, 48, 4)), "squares": np.zeros((32, 48, 1))}
    for sample in range(12):
        drawn = draw(device, scene, view, settings, last=sample)
        part = drawn.part.repeat(BLOCK, 0).repeat(BLOCK, 1)[..., None]
        color, correction = drawn.target("color"), drawn.target("color_correction")
        bright = (color + correction)[..., :3] @ LUMINANCE
        for name, value in (("sum", color), ("sum_correction", correction), ("squares", bright[..., None] ** 2)):
            sums[name] += part * value
    assert not part.all(), "no block was left out of the last sample"
    for name, expected in sums.items():
        assert drawn.target(name) == pytest.approx(expected, rel=1e-4, abs=1e-5), name


def filtered_edge(distance: np.ndarray, reach: float) -> np.ndarray:
    """Part of the Blackman-Harris filter of `reach` px that lies less than `distance` px to the right of its middle."""
    t = np.linspace(-1.0, 1.0, 4001)
    cumulative = np.cumsum(blackman_harris(t))
    return np.interp(distance / reach, t, cumulative / cumulative[-1])


def test_edges_become_as_smooth_as_the_filter(device):
    """A plate that ends at 15.3 px, seen from straight above."""
    plate = quad((-50.0, -50.0, 0.0), (50.0 - 0.7 / 16.0, 0.0, 0.0), (0.0, 100.0, 0.0))
    view = from_above(2.0, (32, 4), filter_width=1.5, transparent=True)
    truth = filtered_edge(15.3 - (np.arange(32) + 0.5), 1.5)
    errors = []
    for samples in (1, 8, 64):
        alpha = draw(device, stage([plate], world=1.0), view, with_quality(SMALL_SETTINGS, samples=samples)).color[
            ..., 3
        ]
        errors.append(np.abs(alpha - truth).max())
    assert errors[0] > 0.15
    assert errors[1] < 0.13
    assert errors[2] < 0.03


def test_every_sample_adds_to_the_penumbra(device):
    """With few light points the error falls as samples are added, to what the shadow maps themselves leave."""
    scene, view = box_over_plane(36, 24)
    truth, _ = reference.picture(scene, view, 10)
    errors = []
    for samples in (1, 4, 24):
        settings = with_quality(MAPS, samples=samples, light_points=3, map_size=96, surface_points=16384)
        color = draw(device, scene, view, settings).color[..., :3].reshape(-1, 3)
        errors.append(reference.nrmse(color, truth))
    assert errors[1] < 0.8 * errors[0]
    assert errors[2] < 0.8 * errors[1]
    assert errors[2] < 0.04


def test_a_new_picture_starts_from_nothing(device):
    scene, view = stage([rubble()], world=1.0), look((3.0, -3.0, 2.0))
    first = draw(device, scene, view, with_quality(SMALL_SETTINGS, samples=3))
    second = draw(device, scene, view, with_quality(SMALL_SETTINGS, samples=2), first.renderer)
    assert np.array_equal(second.color, draw(device, scene, view, with_quality(SMALL_SETTINGS, samples=2)).color)
