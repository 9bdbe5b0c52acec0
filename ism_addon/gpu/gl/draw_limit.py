# SPDX-License-Identifier: GPL-3.0-or-later
"""How much a draw may be, in shadow rays, which take longest: Windows resets a graphics card that has not ended in 2 s.

All that is more is drawn in portions. No blending, and no order of what is blended, changes with that.
"""

from collections.abc import Iterator

#: Rays of a draw at most. Two cores of a processor trace so many in half a second (llvmpipe, 300,000 triangles), and a
#: card is quicker than they are. 1280×720 pixels are fewer: for each light one draw.
MAX_RAYS_PER_DRAW = 1 << 20

#: Texels that are fetched and weighed in the time of a ray; as measured there.
TEXELS_PER_RAY = 400


def portions(count: int, rays: float) -> Iterator[slice]:
    """As few slices of `count` things as are no more than a draw may be; each thing takes the time of so many rays."""
    most = max(int(MAX_RAYS_PER_DRAW / rays), 1)
    return (slice(first, min(first + most, count)) for first in range(0, count, most))


def rectangles(size: tuple[int, int], rays: float) -> Iterator[tuple[int, int, int, int]]:
    """The same of so many columns and rows of pixels: whole rows, or parts of one where that is too much (x,y,w,h)."""
    width, height = size
    for rows in portions(height, rays * width):
        for columns in portions(width, rays * (rows.stop - rows.start)):
            yield columns.start, rows.start, columns.stop - columns.start, rows.stop - rows.start
