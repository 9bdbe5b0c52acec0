# SPDX-License-Identifier: GPL-3.0-or-later
"""More samples than requested, for pictures that are still noisy after them.

Fine detail in small pictures needs more samples than a user expects. So where the requested ones leave a large error,
the tiles with a large error have more.
"""

import math

from ...settings import Quality
from ..convergence import Convergence
from ..passes.film.estimate_error import MIN_SAMPLES_TO_STOP
from ..passes.surfaces.select_tiles import VARIANCE_EXPONENT

#: Estimated error of a picture, relative to its mean luminance, up to which the requested samples suffice. With 16, the
#: scenes of `bench error` and most files of `bench files` are below or near it.
SUFFICIENT_ERROR = 0.03

#: Maximum number of samples, as a multiple of the requested ones. With 4, the error of `bench files` at 16 samples is
#: halved where it is largest.
MAX_REFINEMENT = 4


def sample_limit(quality: Quality, samples: int, error: Convergence) -> int:
    """How many samples a picture has, if `samples` are done: the requested number, or more if its error is then large.

    An error below the user's threshold is not. With fewer than MIN_SAMPLES_TO_STOP the error of tiles is not known well
    enough.
    """
    if quality.samples < MIN_SAMPLES_TO_STOP or not math.isfinite(error.image_error):
        return quality.samples
    expected = error.image_error * max(quality.samples / samples, 1.0) ** (-VARIANCE_EXPONENT / 2.0)
    is_large = expected > max(SUFFICIENT_ERROR, quality.error_threshold)
    return MAX_REFINEMENT * quality.samples if is_large else max(quality.samples, samples)
