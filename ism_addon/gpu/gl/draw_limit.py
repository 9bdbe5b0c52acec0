# SPDX-License-Identifier: GPL-3.0-or-later
"""Limits the cost of a draw, in shadow rays: Windows resets a graphics card if a draw takes 2 s.

Larger draws are split into portions. Blending and its order stay the same. The costs of draws are chosen so that the
largest draws of all passes take about the same time, measured by `bench draws` in the scene atrium.
"""

from collections.abc import Iterator

#: Maximum of rays in a draw. Two processor cores need half a second for them, a graphics card less. An image of
#: 1280×720 pixels takes one draw for each light.
MAX_RAYS_PER_DRAW = 1 << 20

#: Texels that are fetched and weighted in the time of a ray.
TEXELS_PER_RAY = 150


def portions(count: int, rays: float) -> Iterator[slice]:
    """The fewest slices of `count` items within the limit, if an item costs as much as `rays` rays."""
    size = max(int(MAX_RAYS_PER_DRAW / rays), 1)
    return (slice(first, min(first + size, count)) for first in range(0, count, size))


def rectangles(size: tuple[int, int], rays: float) -> Iterator[tuple[int, int, int, int]]:
    """Rectangles (x,y,w,h) of (width, height) pixels within the limit: complete rows, or sections of a row."""
    width, height = size
    for rows in portions(height, rays * width):
        for columns in portions(width, rays * (rows.stop - rows.start)):
            yield columns.start, rows.start, columns.stop - columns.start, rows.stop - rows.start
