# SPDX-License-Identifier: GPL-3.0-or-later
"""What a 3D viewport decides without its window; what it shows is looked at in a Blender that has one."""

import pytest

from ism_addon.blender.viewport.viewport import COARSEST, FIRST, next_preview_size


@pytest.mark.parametrize(
    ("pixel", "seconds", "then"),
    [
        (4, 3.0 * FIRST, 8),
        (COARSEST, 3.0 * FIRST, COARSEST),
        (4, FIRST, 4),
        (4, 0.1 * FIRST, 2),
        (1, 0.1 * FIRST, 1),
    ],
)
def test_the_first_pictures_pixels_are_as_coarse_as_its_time_allows(pixel, seconds, then):
    assert next_preview_size(pixel, seconds) == then


def test_an_even_pace_settles():
    for time_of_a_pixel in (1e-6, 1e-4, 1e-2, 1.0):
        pixel, widths = 4, []
        for _ in range(20):
            pixel = next_preview_size(pixel, time_of_a_pixel / pixel**2)
            widths.append(pixel)
        assert len(set(widths[10:])) == 1
