# SPDX-License-Identifier: GPL-3.0-or-later
"""Four measures of a picture's error. All pictures are linear light, (H,W,3).

The truth is two pictures A and B, `halves`, with independent noise: the expected value of (x - A)(x - B) is the squared
error of x without that noise. RMSE and relMSE are measured so, although relMSE's denominator has noise. The percentile
and FLIP compare with the mean of the halves, noise included.
"""

from dataclasses import dataclass

import numpy as np

from ism_addon.color import srgb_from_linear

#: Added to the squared truth in relMSE's denominator, for a truth of mean 1. 0.01 is usual in publications.
EPSILON = 0.01
PERCENTILE = 99.0


@dataclass(frozen=True)
class Error:
    """A picture's errors; 0 for the truth. The record has these names."""

    rmse: float  # relative to the truth's mean
    relmse: float  # mean of squared error / squared truth
    percentile: float  # 99th, of |error| / mean of the truth, over all pixels and channels
    flip: float  # mean, for a viewer at 67 pixels a degree


def errors(picture: np.ndarray, halves: np.ndarray) -> Error:
    """All errors of a picture against the truth's halves (2,H,W,3)."""
    truth = halves.mean(0)
    difference = np.abs(picture - truth)
    return Error(
        rmse=rmse(picture, halves),
        relmse=relmse(picture, halves),
        percentile=float(np.percentile(difference, PERCENTILE) / truth.mean()),
        flip=flip(picture, truth),
    )


def squared_errors(picture: np.ndarray, halves: np.ndarray) -> np.ndarray:
    """(H,W,3) float64: unbiased estimates of the squared error, without the truth's noise. They may be negative."""
    exact = picture.astype(np.float64)
    return (exact - halves[0]) * (exact - halves[1])


def rmse(picture: np.ndarray, halves: np.ndarray) -> float:
    """Root of the mean squared error, over the truth's mean; 0 if the estimate is negative because of noise."""
    return float(np.sqrt(max(squared_errors(picture, halves).mean(), 0.0)) / halves.mean(dtype=np.float64))


def relmse(picture: np.ndarray, halves: np.ndarray) -> float:
    """Mean of squared error over squared truth, to which EPSILON times the squared mean is added for dark pixels."""
    truth, mean = halves.mean(0, dtype=np.float64), halves.mean(dtype=np.float64)
    return float(max((squared_errors(picture, halves) / (truth**2 + EPSILON * mean**2)).mean(), 0.0))


def flip(picture: np.ndarray, truth: np.ndarray) -> float:
    """Mean FLIP between the sRGB-encoded pictures (Andersson et al. 2020, the authors' package)."""
    from flip_evaluator import evaluate  # here, because tests of the other measures run without this package

    encoded = [srgb_from_linear(np.clip(each, 0.0, 1.0)).astype(np.float32) for each in (truth, picture)]
    return float(evaluate(*encoded, "LDR", inputsRGB=True, applyMagma=False)[1])


def noise(halves: np.ndarray) -> float:
    """RMSE of the halves' mean, over the truth's mean, from the difference of the halves."""
    return float(np.sqrt(((halves[0] - halves[1]) ** 2).mean(dtype=np.float64)) / 2.0 / halves.mean(dtype=np.float64))


def resolution(halves: np.ndarray) -> float:
    """RMSE/mean below which an error is lost in the noise: two standard deviations of the mean squared error."""
    fourth = ((halves[0] - halves[1]).astype(np.float64) ** 4).mean() / 12.0  # each half's variance, squared
    deviation = np.sqrt(fourth / halves[0].size)
    return float(np.sqrt(2.0 * deviation) / halves.mean(dtype=np.float64))
