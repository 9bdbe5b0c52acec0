# SPDX-License-Identifier: GPL-3.0-or-later
"""The error measures of the benchmark, compared with cases that can be computed by hand."""

import math

import numpy as np
import pytest

from tests.benchmark.error.curve import Point, error_at, medians, time_to
from tests.benchmark.error.metrics import EPSILON, Error, errors, flip, noise, relmse, resolution, rmse

SHAPE = (120, 160, 3)


@pytest.fixture
def truth():
    return np.random.default_rng(1).uniform(0.2, 1.8, SHAPE)


def noisy(truth: np.ndarray, deviation: float) -> np.ndarray:
    """Two halves of a truth, with independent noise."""
    return truth + deviation * np.random.default_rng(2).normal(size=(2, *SHAPE))


def test_rmse_is_relative_to_the_truths_mean(truth):
    assert rmse(truth + 0.1, np.stack([truth, truth])) == pytest.approx(0.1 / truth.mean())


def test_the_truths_noise_is_not_counted(truth):
    halves = noisy(truth, 0.05)
    noisy_picture = truth + 0.05 * np.random.default_rng(3).normal(size=SHAPE)
    assert rmse(noisy_picture, halves) == pytest.approx(0.05 / truth.mean(), rel=0.02)
    assert relmse(noisy_picture, halves) == pytest.approx(relmse(noisy_picture, np.stack([truth, truth])), rel=0.1)


def test_noise_is_that_of_the_mean_of_the_halves(truth):
    assert noise(noisy(truth, 0.3)) == pytest.approx(0.3 / math.sqrt(2.0) / truth.mean(), rel=0.02)


def test_the_error_of_the_truth_itself_is_below_the_resolution(truth):
    halves = noisy(truth, 0.3)
    # σ⁴/N is the variance of the mean of N products of two noises.
    assert resolution(halves) == pytest.approx(math.sqrt(2.0 * 0.09 / math.sqrt(truth.size)) / truth.mean(), rel=0.05)
    assert rmse(truth, halves) < resolution(halves)


def test_relmse_divides_by_the_truth_and_is_finite_where_that_is_black():
    truth = np.full(SHAPE, 2.0)
    truth[:60] = 0.0  # the mean is 1
    halves = np.stack([truth, truth])
    expected = 0.5 * 0.01 / EPSILON + 0.5 * 0.01 / (4.0 + EPSILON)
    assert relmse(truth + 0.1, halves) == pytest.approx(expected)
    assert relmse(7.0 * (truth + 0.1), 7.0 * halves) == pytest.approx(expected), "the exposure must not matter"


def test_the_percentile_shows_large_errors_of_few_pixels(truth):
    pytest.importorskip("flip_evaluator", reason="dev.py bench installs it")
    picture = truth.copy()
    picture[:, :4] += 1.0  # 2.5 % of all pixels
    error = errors(picture, np.stack([truth, truth]))
    assert error.percentile == pytest.approx(1.0 / truth.mean())


def test_flip_is_zero_for_equal_pictures_and_large_for_black_and_white(truth):
    pytest.importorskip("flip_evaluator", reason="dev.py bench installs it")
    assert flip(truth, truth) < 1e-4
    assert flip(np.zeros(SHAPE), np.ones(SHAPE)) > 0.5


def points(*pairs: tuple[float, float]) -> list[Point]:
    return [Point(n, seconds, Error(error, 0.0, 0.0, 0.0)) for n, (seconds, error) in enumerate(pairs)]


def test_a_curve_is_interpolated_and_extrapolated_in_log_log():
    curve = points((1.0, 0.4), (4.0, 0.2), (16.0, 0.1))
    assert time_to(curve, 0.4) == time_to(curve, 1.0) == 1.0
    assert time_to(curve, 0.1 * 2.0**0.5) == pytest.approx(8.0)
    assert time_to(curve, 0.05) == pytest.approx(64.0)
    assert error_at(curve, 2.0) == pytest.approx(0.2 * 2.0**0.5)
    assert error_at(curve, 64.0) == pytest.approx(0.05)
    assert error_at(curve, 0.9) == math.inf, "there is no error before the first picture"


def test_a_flat_curve_never_reaches_a_lower_error():
    assert time_to(points((1.0, 0.4), (4.0, 0.4)), 0.1) == math.inf
    assert time_to(points((1.0, 0.4), (4.0, 0.399)), 0.1) == math.inf


def test_medians_are_of_samples_that_every_repetition_has():
    repetitions = [points((1.0, 0.5), (2.0, 0.3)), points((3.0, 0.1)), points((2.0, 0.2), (4.0, 0.1))]
    assert medians(repetitions) == points((2.0, 0.2))
