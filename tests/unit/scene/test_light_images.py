# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of lights are resampled by means over areas."""

import numpy as np
import pytest

from ism_addon.scene.light_images import resampled

COLORS = np.random.default_rng(0).random((12, 20, 3)).astype(np.float32)


def test_each_texel_is_the_mean_of_those_that_it_covers():
    expected = COLORS.reshape(4, 3, 5, 4, 3).mean((1, 3))
    assert resampled(COLORS, 4, 5) == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("size", [(1, 1), (5, 7), (12, 20), (11, 3)])
def test_the_mean_stays(size):
    new = resampled(COLORS, *size)
    assert new.shape == (*size, 3)
    assert new.mean((0, 1)) == pytest.approx(COLORS.mean((0, 1)), abs=1e-6)


def test_parts_of_texels_count_by_their_area():
    assert resampled(COLORS[:3], 2, 20)[0] == pytest.approx((COLORS[0] + 0.5 * COLORS[1]) / 1.5, abs=1e-6)
