# SPDX-License-Identifier: GPL-3.0-or-later
"""Limits the cost of a draw, in shadow rays: Windows resets a graphics card if a draw takes 2 s.

Larger draws are split into portions. Blending and its order stay the same. What draws cost is chosen so that the
largest of all passes take about as long, by `bench draws` in the scene atrium.
"""

from collections.abc import Iterator

#: Most rays of a draw. Two processor cores trace so many in half a second, and a graphics card is faster. An image of
#: 1280×720 pixels takes one draw for each light.
MAX_RAYS_PER_DRAW = 1 << 20

#: Texels that are fetched and weighted in the time of a ray.
TEXELS_PER_RAY = 150


def portions(count: int, rays: float) -> Iterator[slice]:
    """The fewest slices of `count` items that are within the limit; each item takes the time of `rays` rays."""
    size = max(int(MAX_RAYS_PER_DRAW / rays), 1)
    return (slice(first, min(first + size, count)) for first in range(0, count, size))


def rectangles(size: tuple[int, int], rays: float) -> Iterator[tuple[int, int, int, int]]:
    """Likewise of (width, height) pixels: rectangles (x,y,w,h) of whole rows, or parts of a row."""
    width, height = size
    for rows in portions(height, rays * width):
        for columns in portions(width, rays * (rows.stop - rows.start)):
            yield columns.start, rows.start, columns.stop - columns.start, rows.stop - rows.start
