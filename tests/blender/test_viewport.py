# SPDX-License-Identifier: GPL-3.0-or-later
"""What a 3D viewport decides without its window; what it shows is looked at in a Blender that has one."""

import pytest

from ism_addon.blender.viewport.viewport import MAX_PREVIEW_PIXEL_SIZE, PREVIEW_SECONDS, next_preview_pixel_size


@pytest.mark.parametrize(
    ("pixel", "seconds", "then"),
    [
        (4, 3.0 * PREVIEW_SECONDS, 8),
        (MAX_PREVIEW_PIXEL_SIZE, 3.0 * PREVIEW_SECONDS, MAX_PREVIEW_PIXEL_SIZE),
        (4, PREVIEW_SECONDS, 4),
        (4, 0.1 * PREVIEW_SECONDS, 2),
        (1, 0.1 * PREVIEW_SECONDS, 1),
    ],
)
def test_the_first_pictures_pixels_are_as_coarse_as_its_time_allows(pixel, seconds, then):
    assert next_preview_pixel_size(pixel, seconds) == then


def test_an_even_pace_settles():
    for time_of_a_pixel in (1e-6, 1e-4, 1e-2, 1.0):
        pixel, widths = 4, []
        for _ in range(20):
            pixel = next_preview_pixel_size(pixel, time_of_a_pixel / pixel**2)
            widths.append(pixel)
        assert len(set(widths[10:])) == 1
