# SPDX-License-Identifier: GPL-3.0-or-later
"""The error estimate, from how far means move as samples are added, on data whose true error is known."""

import numpy as np
import pytest

from ism_addon.gpu.convergence import Convergence, neighbourhood_mean

SHAPE = 40, 50


def estimate_and_truth(counts: np.ndarray, half_counts: np.ndarray) -> tuple[Convergence, np.ndarray]:
    """The estimate for (H,W) tiles of 64 pixels with normally distributed samples, and the tiles' true mean squares."""
    random = np.random.default_rng(1)
    deviation = random.uniform(0.1, 3.0, SHAPE)
    samples = deviation[..., None, None] * random.normal(size=(*SHAPE, 64, int(counts.max())))
    index = np.arange(samples.shape[-1])
    half = (samples * (index < half_counts[..., None, None])).sum(-1) / half_counts[..., None]
    mean = (samples * (index < counts[..., None, None])).sum(-1) / counts[..., None]
    error = Convergence(SHAPE)
    error.counts, error.half_counts = counts.astype(np.float32), half_counts
    error.update(((mean - half) ** 2).mean(-1))
    return error, (mean**2).mean(-1)


def test_the_estimate_is_the_true_error_whatever_the_sample_counts():
    random = np.random.default_rng(0)
    half_counts = random.integers(1, 9, SHAPE).astype(np.float32)
    error, truth = estimate_and_truth(half_counts + random.integers(1, 20, SHAPE), half_counts)
    assert error.image_error == pytest.approx(np.sqrt(truth.mean()), rel=0.05)
    ratio = np.sqrt(error.variance / error.counts / truth)
    assert np.median(ratio) == pytest.approx(1.0, abs=0.05)
    assert ratio.min() > 0.5
    assert ratio.max() < 2.0


def test_the_estimate_falls_as_samples_are_added():
    error, _ = estimate_and_truth(np.full(SHAPE, 8), np.full(SHAPE, 4.0))
    before = error.image_error
    error.counts = error.counts + 24
    assert error.image_error == pytest.approx(before / 2.0)


def test_the_error_is_infinite_before_the_second_sample():
    error = Convergence(SHAPE)
    error.counts = np.ones(SHAPE, np.float32)
    assert error.image_error == np.inf
    error.stop_below(1.0)
    assert not error.converged.any()


def test_a_converged_tile_keeps_its_variance():
    """Also that of its last samples, which may be few: otherwise its neighbours might never converge."""
    error = Convergence(SHAPE)
    error.counts, error.half_counts = np.full(SHAPE, 8.0, np.float32), np.full(SHAPE, 4.0, np.float32)
    error.update(np.full(SHAPE, 1e-6))
    error.stop_below(0.01)
    error.half_counts, error.counts = error.counts, error.counts + 1.0
    error.update(np.full(SHAPE, 1.0))
    assert error.converged.all()
    assert error.image_error < 0.01


def test_a_tile_without_new_samples_keeps_its_variance():
    error, _ = estimate_and_truth(np.full(SHAPE, 8), np.full(SHAPE, 4.0))
    before, error.half_counts = error.variance.copy(), error.counts
    error.counts = error.counts + (np.arange(50) < 25)
    error.update(np.full(SHAPE, 1.0))
    assert np.array_equal(error.variance[:, 25:], before[:, 25:])
    assert error.variance[:, :25] == pytest.approx(1.0 / (1.0 / 8.0 - 1.0 / 9.0), rel=1e-4)


def test_a_tile_has_converged_if_it_and_its_neighbours_are_below_the_threshold():
    error = Convergence((3, 7))
    error.counts = np.ones((3, 7), np.float32)
    error.variance[:] = 0.25
    error.variance[1, 1] = 10.0
    error.stop_below(0.6)
    assert np.array_equal(error.converged, np.repeat([np.arange(7) > 2], 3, 0))
    error.stop_below(0.4)
    assert error.converged.any(), "a converged tile stays converged"


def test_the_neighbourhood_mean():
    values = np.random.default_rng(5).random((4, 6))
    assert neighbourhood_mean(values)[1, 2] == pytest.approx(values[:3, 1:4].mean())
    assert neighbourhood_mean(values)[0, 0] == pytest.approx(np.pad(values, 1, mode="edge")[:3, :3].mean())
