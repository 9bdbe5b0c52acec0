# SPDX-License-Identifier: GPL-3.0-or-later
"""The estimate of errors from how far means move as samples are added, on numbers whose errors are known."""

import numpy as np
import pytest

from ism_addon.gpu.convergence import Convergence, neighbourhood_mean

SHAPE = 40, 50


def after(counts: np.ndarray, earlier: np.ndarray) -> tuple[Convergence, np.ndarray]:
    """The estimate of blocks (H,W) of 64 means of normal samples, and the blocks' true mean squares."""
    random = np.random.default_rng(1)
    deviation = random.uniform(0.1, 3.0, SHAPE)
    samples = deviation[..., None, None] * random.normal(size=(*SHAPE, 64, int(counts.max())))
    upto = np.arange(samples.shape[-1])
    first = (samples * (upto < earlier[..., None, None])).sum(-1) / earlier[..., None]
    whole = (samples * (upto < counts[..., None, None])).sum(-1) / counts[..., None]
    error = Convergence(SHAPE)
    error.counts, error.half_counts = counts.astype(np.float32), earlier
    error.update(((whole - first) ** 2).mean(-1))
    return error, (whole**2).mean(-1)


def test_it_is_the_true_error_however_many_samples_there_were_and_are():
    random = np.random.default_rng(0)
    earlier = random.integers(1, 9, SHAPE).astype(np.float32)
    error, truth = after(earlier + random.integers(1, 20, SHAPE), earlier)
    assert error.image_error == pytest.approx(np.sqrt(truth.mean()), rel=0.05)
    ratio = np.sqrt(error.variance / error.counts / truth)
    assert np.median(ratio) == pytest.approx(1.0, abs=0.05)
    assert ratio.min() > 0.5
    assert ratio.max() < 2.0


def test_it_falls_as_samples_are_added():
    error, _ = after(np.full(SHAPE, 8), np.full(SHAPE, 4.0))
    before = error.image_error
    error.counts = error.counts + 24
    assert error.image_error == pytest.approx(before / 2.0)


def test_nothing_is_known_before_the_second_sample():
    error = Convergence(SHAPE)
    error.counts = np.ones(SHAPE, np.float32)
    assert error.image_error == np.inf
    error.stop_below(1.0)
    assert not error.converged.any()


def test_a_block_that_has_not_taken_part_is_as_before():
    error, _ = after(np.full(SHAPE, 8), np.full(SHAPE, 4.0))
    before, error.half_counts = error.variance.copy(), error.counts
    error.counts = error.counts + (np.arange(50) < 25)
    error.update(np.full(SHAPE, 1.0))
    assert np.array_equal(error.variance[:, 25:], before[:, 25:])
    assert error.variance[:, :25] == pytest.approx(1.0 / (1.0 / 8.0 - 1.0 / 9.0), rel=1e-4)


def test_a_tile_has_converged_if_it_and_those_about_it_are_good_enough():
    error = Convergence((3, 7))
    error.counts = np.ones((3, 7), np.float32)
    error.variance[:] = 0.25
    error.variance[1, 1] = 10.0
    error.stop_below(0.6)
    assert np.array_equal(error.converged, np.repeat([np.arange(7) > 2], 3, 0))
    error.stop_below(0.4)
    assert error.converged.any(), "what has converged stays so"


def test_mean_around():
    values = np.random.default_rng(5).random((4, 6))
    assert neighbourhood_mean(values)[1, 2] == pytest.approx(values[:3, 1:4].mean())
    assert neighbourhood_mean(values)[0, 0] == pytest.approx(np.pad(values, 1, mode="edge")[:3, :3].mean())
