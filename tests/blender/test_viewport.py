# SPDX-License-Identifier: GPL-3.0-or-later
"""The pixel size of a viewport's preview, without a window. tests/gui tests viewports in a window."""

import pytest

from ism_addon.blender.viewport.viewport import MAX_PREVIEW_PIXEL_SIZE, PREVIEW_SECONDS, next_preview_pixel_size


@pytest.mark.parametrize(
    ("pixel_size", "seconds", "expected"),
    [
        (4, 3.0 * PREVIEW_SECONDS, 8),
        (MAX_PREVIEW_PIXEL_SIZE, 3.0 * PREVIEW_SECONDS, MAX_PREVIEW_PIXEL_SIZE),
        (4, PREVIEW_SECONDS, 4),
        (4, 0.1 * PREVIEW_SECONDS, 2),
        (1, 0.1 * PREVIEW_SECONDS, 1),
    ],
)
def test_the_preview_pixel_size_follows_the_time_of_the_last_preview(pixel_size, seconds, expected):
    assert next_preview_pixel_size(pixel_size, seconds) == expected


def test_the_preview_pixel_size_converges_at_a_constant_speed():
    for seconds_per_pixel in (1e-6, 1e-4, 1e-2, 1.0):
        pixel_size, sizes = 4, []
        for _ in range(20):
            pixel_size = next_preview_pixel_size(pixel_size, seconds_per_pixel / pixel_size**2)
            sizes.append(pixel_size)
        assert len(set(sizes[10:])) == 1
