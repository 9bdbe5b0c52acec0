# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a picture is from the truth, four ways; all pictures are linear light, (H,W,3).

The truth is two pictures, `halves`, with independent noise: (x - A)(x - B) is on average the squared error of x
without that noise. RMSE and relMSE are measured so (but what relMSE divides by keeps some); the percentile and FLIP
take the halves' mean, noise and all.
"""

from dataclasses import dataclass

import numpy as np

from ism_addon.color import srgb_from_linear

#: Added to the squared truth that relMSE divides by, once the truth's mean is 1: the field's usual hundredth.
EPSILON = 0.01
PERCENTILE = 99.0


@dataclass(frozen=True)
class Error:
    """Smaller is better; 0 is the truth."""

    rmse: float  # over the truth's mean
    relmse: float  # mean of squared error over squared truth
    percentile: float  # of |error| over the truth's mean, over all pixels and channels
    flip: float  # mean, for a viewer at 67 pixels a degree


def errors(picture: np.ndarray, halves: np.ndarray) -> Error:
    """All of a picture's errors against the truth's halves (2,H,W,3)."""
    truth = halves.mean(0)
    off = np.abs(picture - truth)
    return Error(
        rmse=rmse(picture, halves),
        relmse=relmse(picture, halves),
        percentile=float(np.percentile(off, PERCENTILE) / truth.mean()),
        flip=flip(picture, truth),
    )


def squares(picture: np.ndarray, halves: np.ndarray) -> np.ndarray:
    """(H,W,3) float64: each pixel's squared error, on average without the truth's noise; may be negative."""
    exact = picture.astype(np.float64)
    return (exact - halves[0]) * (exact - halves[1])


def rmse(picture: np.ndarray, halves: np.ndarray) -> float:
    """Root of the mean squared error over the truth's mean, 0 where it cannot be told from the noise."""
    return float(np.sqrt(max(squares(picture, halves).mean(), 0.0)) / halves.mean(dtype=np.float64))


def relmse(picture: np.ndarray, halves: np.ndarray) -> float:
    """Mean of squared error over squared truth, with EPSILON times the squared mean for the darkness."""
    truth, level = halves.mean(0, dtype=np.float64), halves.mean(dtype=np.float64)
    return float(max((squares(picture, halves) / (truth**2 + EPSILON * level**2)).mean(), 0.0))


def flip(picture: np.ndarray, truth: np.ndarray) -> float:
    """Mean FLIP between the pictures as a screen shows them (Andersson et al. 2020, the authors' package)."""
    from flip_evaluator import evaluate  # the tests of the other measures get by without it

    shown = [srgb_from_linear(np.clip(each, 0.0, 1.0)).astype(np.float32) for each in (truth, picture)]
    return float(evaluate(*shown, "LDR", inputsRGB=True, applyMagma=False)[1])


def noise(halves: np.ndarray) -> float:
    """RMSE of the halves' mean over its level, from how the halves differ."""
    return float(np.sqrt(((halves[0] - halves[1]) ** 2).mean(dtype=np.float64)) / 2.0 / halves.mean(dtype=np.float64))


def resolution(halves: np.ndarray) -> float:
    """RMSE over mean below which a picture cannot be told from the truth: twice what chance gives the truth itself."""
    fourth = ((halves[0] - halves[1]).astype(np.float64) ** 4).mean() / 12.0  # each half's variance, squared
    deviation = np.sqrt(fourth / halves[0].size)
    return float(np.sqrt(2.0 * deviation) / halves.mean(dtype=np.float64))
