# SPDX-License-Identifier: GPL-3.0-or-later
"""More samples than requested, for pictures that are still noisy after them.

Fine detail in small pictures needs more samples than a user expects, and so do single bright edges in large ones. So
the tiles in which more samples would soon lower the error of the picture have more.
"""

import math

import numpy as np

from ...resources import TILE_SIZE
from ...settings import Quality
from ..convergence import Convergence
from ..passes.film.estimate_error import MIN_SAMPLES_TO_STOP
from ..passes.surfaces.select_tiles import VARIANCE_EXPONENT

#: The error, relative to the mean luminance, that is as bad as the time of a sample of a million pixels of few lights.
#: With it the median error of `bench files`, whose pictures are small, is below 0.03 with 16 samples.
ERROR_PER_MEGAPIXEL = 1.5e-3

#: The error that is sufficient for any picture, however small.
MIN_SUFFICIENT_ERROR = 0.01

#: The error is proportional to this power of 1 / n.
ERROR_EXPONENT = VARIANCE_EXPONENT / 2.0

#: Maximum number of samples, as a multiple of the requested ones.
MAX_REFINEMENT = 8


def sample_limit(quality: Quality, samples: int, error: Convergence, excess_lights: float) -> int:
    """How many samples a picture has, if `samples` are done: the requested number, or more if its error is then large.

    With fewer than MIN_SAMPLES_TO_STOP the error of tiles is not known well enough. `excess_lights`: see TileSelection.
    """
    if quality.samples < MIN_SAMPLES_TO_STOP or not math.isfinite(error.image_error):
        return quality.samples
    expected = error.image_error * max(quality.samples / samples, 1.0) ** -ERROR_EXPONENT
    sufficient = sufficient_error(quality, error.counts.size, excess_lights, max(quality.samples, samples))
    return MAX_REFINEMENT * quality.samples if expected > sufficient else max(quality.samples, samples)


def sufficient_error(quality: Quality, tiles: int, excess_lights: float, samples: int) -> float:
    """The error of a picture, the same in all of its tiles, with which it has no more samples than these.

    One more lowers an error e after n samples by ERROR_EXPONENT e / n. The user's threshold suffices, too.
    """
    error = error_per_sample(tiles, excess_lights) * samples / ERROR_EXPONENT
    return max(error, MIN_SUFFICIENT_ERROR, quality.error_threshold)


def sufficient_errors(quality: Quality, error: Convergence, excess_lights: float) -> np.ndarray:
    """(rows,columns): the errors of tiles with which they have no more samples.

    One more of a tile of error t lowers the picture's error e by ERROR_EXPONENT t² / (e n), over the number of tiles.
    """
    squares = error_per_sample(error.counts.size, excess_lights) / ERROR_EXPONENT * error.image_error * error.counts
    errors: np.ndarray = np.maximum(np.sqrt(squares), max(MIN_SUFFICIENT_ERROR, quality.error_threshold))
    return errors


def error_per_sample(tiles: int, excess_lights: float) -> float:
    """The error that is as bad as the time of a sample, which the number of pixels and of lights tells."""
    return ERROR_PER_MEGAPIXEL * tiles * TILE_SIZE**2 / 1e6 * excess_lights
