# SPDX-License-Identifier: GPL-3.0-or-later
"""More samples mean a better picture: edges and penumbrae."""

from dataclasses import replace

import numpy as np
import pytest

from . import reference
from .scenes.small import box_over_plane
from .studio import SMALL_SETTINGS, draw, from_above, look, quad, rubble, stage, with_quality


def test_the_picture_is_the_mean_of_its_samples(device):
    from ism_addon.gpu.profile import Profile
    from ism_addon.gpu.renderer import Renderer

    scene, view = box_over_plane(24, 16)
    view = replace(view, filter_width=1.5)
    settings = with_quality(SMALL_SETTINGS, samples=5)
    apart, renderer = [], Renderer(device)
    for sample in range(5):
        for _ in renderer.sample(scene, view, settings, sample, Profile()):
            pass
        texture = renderer.targets["color"]
        apart.append(np.frombuffer(texture.read(), "f4").reshape(16, 24, 4).astype(float))
    assert np.std(apart, axis=0).max() > 0.01
    assert draw(device, scene, view, settings).color == pytest.approx(np.mean(apart, axis=0), abs=1e-6)


def filtered_edge(distance: np.ndarray, width: float) -> np.ndarray:
    """Part of the Blackman-Harris filter of `width` px that lies less than `distance` px to the right of its middle."""
    t = np.linspace(-0.5, 0.5, 4001)
    k = 2.0 * np.pi * (t + 0.5)
    window = 0.35875 - 0.48829 * np.cos(k) + 0.14128 * np.cos(2 * k) - 0.01168 * np.cos(3 * k)
    return np.interp(distance / width, t, np.cumsum(window) / window.sum())


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
    assert errors[1] < 0.12
    assert errors[2] < 0.03


def test_every_sample_adds_to_the_penumbra(device):
    """With few light points the error falls as samples are added, to what the maps themselves leave."""
    scene, view = box_over_plane(36, 24)
    truth, _ = reference.picture(scene, view, 10)
    errors = []
    for samples in (1, 4, 24):
        settings = with_quality(SMALL_SETTINGS, samples=samples, light_points=3, map_size=96, surface_points=16384)
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
