# SPDX-License-Identifier: GPL-3.0-or-later
"""More samples than requested, for pictures that are still noisy after them.

Fine detail in small pictures needs more samples than a user expects. So where the requested ones leave an error that
more samples would soon lower, the tiles with such an error have more.
"""

import math

from ...resources import TILE_SIZE
from ...settings import Quality
from ..convergence import Convergence
from ..passes.film.estimate_error import MIN_SAMPLES_TO_STOP
from ..passes.surfaces.select_tiles import VARIANCE_EXPONENT

#: Error, relative to the mean luminance, up to which a picture of a million pixels and few lights has no more samples
#: than requested. With it the median error of `bench files`, whose pictures are small, is below 0.02 with 16 samples.
SUFFICIENT_ERROR = 0.04

#: The least such error, of pictures however small.
MIN_SUFFICIENT_ERROR = 0.01

#: The error is proportional to this power of 1 / n. An error and the time for n samples, in proportion to the time of
#: one, have the smallest sum where the error is proportional to a power of the latter.
ERROR_EXPONENT = VARIANCE_EXPONENT / 2.0
TIME_EXPONENT = ERROR_EXPONENT / (1.0 + ERROR_EXPONENT)

#: Maximum number of samples, as a multiple of the requested ones. With 4, the error of `bench files` at 16 samples is
#: halved where it is largest.
MAX_REFINEMENT = 4


def sufficient_error(quality: Quality, tiles: int, excess_lights: float) -> float:
    """The error up to which a picture has no more samples than requested. `excess_lights`: see TileSelection.

    The user's threshold suffices, too.
    """
    megapixels = tiles * TILE_SIZE**2 / 1e6
    sufficient = SUFFICIENT_ERROR * (megapixels * excess_lights) ** TIME_EXPONENT
    return max(sufficient, MIN_SUFFICIENT_ERROR, quality.error_threshold)


def sample_limit(quality: Quality, samples: int, error: Convergence, sufficient: float) -> int:
    """How many samples a picture has, if `samples` are done: the requested number, or more if its error is then large.

    With fewer than MIN_SAMPLES_TO_STOP the error of tiles is not known well enough.
    """
    if quality.samples < MIN_SAMPLES_TO_STOP or not math.isfinite(error.image_error):
        return quality.samples
    expected = error.image_error * max(quality.samples / samples, 1.0) ** -ERROR_EXPONENT
    return MAX_REFINEMENT * quality.samples if expected > sufficient else max(quality.samples, samples)
