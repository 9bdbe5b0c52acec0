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
    for sample in upto:
        error.count(sample < counts)
    error.compare(((whole - first) ** 2).mean(-1), earlier)
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
    for _ in range(24):
        error.count(np.ones(SHAPE, bool))
    assert error.image_error == pytest.approx(before / 2.0)


def test_nothing_is_known_before_the_second_sample():
    error = Convergence(SHAPE)
    error.count(np.ones(SHAPE, bool))
    assert error.image_error == np.inf
    error.settle(1.0)
    assert not error.settled.any()


def test_a_block_that_has_not_taken_part_is_as_before():
    error, _ = after(np.full(SHAPE, 8), np.full(SHAPE, 4.0))
    before, earlier = error.variance.copy(), error.counts.copy()
    error.count(np.arange(50) < 25)
    error.compare(np.full(SHAPE, 1.0), earlier)
    assert np.array_equal(error.variance[:, 25:], before[:, 25:])
    assert error.variance[:, :25] == pytest.approx(1.0 / (1.0 / 8.0 - 1.0 / 9.0), rel=1e-4)


def test_a_block_is_settled_if_it_and_those_about_it_are_good_enough():
    error = Convergence((3, 7))
    error.count(np.ones((3, 7), bool))
    error.variance[:] = 0.25
    error.variance[1, 1] = 10.0
    error.settle(0.6)
    assert np.array_equal(error.settled, np.repeat([np.arange(7) > 2], 3, 0))
    error.settle(0.4)
    assert error.settled.any(), "what is settled stays so"


def test_a_settled_block_counts_no_further_sample():
    error = Convergence((1, 2))
    error.settled[0, 0] = True
    error.count(np.ones((1, 2), bool))
    assert error.counts.tolist() == [[0.0, 1.0]]


def test_mean_around():
    values = np.random.default_rng(5).random((4, 6))
    assert neighbourhood_mean(values)[1, 2] == pytest.approx(values[:3, 1:4].mean())
    assert neighbourhood_mean(values)[0, 0] == pytest.approx(np.pad(values, 1, mode="edge")[:3, :3].mean())
