# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of pictures of worlds beside Cycles."""

import numpy as np

from tests.benchmark.files import FILTER_WIDTH
from tests.scenes.cycles import direct_light

#: Samples of each of Cycles' two pictures.
TRUTH = 128


def error(ours, truth=TRUTH, darker_than=np.inf):
    """RMSE over the mean, without the noise of Cycles' picture, of pixels that are darker than a radiance."""
    halves = np.stack([direct_light(truth, FILTER_WIDTH, seed=seed)[..., :3] for seed in (1, 2)])
    first, second = halves[:, halves.mean(0).max(2) < darker_than]
    ours = ours[halves.mean(0).max(2) < darker_than]
    mean = 0.5 * (first.mean() + second.mean())
    return float(np.sqrt(max(((ours - first) * (ours - second)).mean(), 0.0)) / mean)
