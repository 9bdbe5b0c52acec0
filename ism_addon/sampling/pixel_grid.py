# SPDX-License-Identifier: GPL-3.0-or-later
"""Subpixel offsets of samples: on a grid that several samples share, or distributed like a narrow filter."""

import math
from dataclasses import dataclass
from functools import cache, lru_cache

import numpy as np

from .dimensions import Dimension, draw


@dataclass(frozen=True, eq=False)
class PixelGrid:
    """A grid of texels, finer than the pixels and rotated relative to them, and samples' subpixel offsets on it."""

    fine_from_pixel: np.ndarray  # (2,2) int
    offset: np.ndarray  # (2,) px: from pixels' centres to the centres of texels
    texels: np.ndarray  # (N,2) int: the texel of each sample, relative to the one at the pixel's centre
    subpixel_offsets: np.ndarray  # (N,2) px: of samples from the pixel's centre

    @lru_cache(maxsize=64)  # noqa: B019 (few grids, which are small)
    def bounds(self, width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
        """(2,) each: the texel of the picture's first pixel, and the number of columns and rows of texels."""
        corners = np.array([[0, 0], [width - 1, 0], [0, height - 1], [width - 1, height - 1]]) @ self.fine_from_pixel.T
        first = -corners.min(0) - self.texels.min(0)
        return first, np.ptp(corners, axis=0) + np.ptp(self.texels, axis=0) + 1

    @lru_cache(maxsize=64)  # noqa: B019 (likewise)
    def max_size(self, width: int, height: int) -> np.ndarray:
        """(2,): upper bounds of columns and rows of a grid of this spacing, for any subpixel offsets."""
        _, size = self.bounds(width, height)
        return size - np.ptp(self.texels, axis=0) + np.abs(self.fine_from_pixel).sum(1) + 1

    def fine_from_clip(self, width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
        """(2,2) and (2,): factors of clip coordinates x, y and of w that give clip coordinates of the grid."""
        (first, fine), size = self.bounds(width, height), np.array([width, height])
        shift = self.fine_from_pixel @ (size / 2.0 - 0.5 - self.offset) + 0.5 + first
        return self.fine_from_pixel * size / fine[:, None], 2.0 * shift / fine - 1.0


#: A filter is wide from this margin on, in pixels.
WIDE_MARGIN = 5

#: Subpixel offsets are a rank-1 lattice of this generator, in van der Corput's order, so that the first 2, 4, 8, … are
#: a lattice as well (Hickernell et al. 2000). All x and all y differ, because edges in pictures are often parallel to
#: the pixels' sides. Of all generators it has the largest minimum distance in its lattices of up to 4,096 points.
LATTICE_GENERATOR = 3045

#: Texels from pixels, by the number of samples that share a grid. A texel's sides are the lattice's shortest vectors.
PIXEL_GRIDS = {1: [[1, 0], [0, 1]], 4: [[2, 2], [-1, 1]], 16: [[5, -1], [1, 3]]}

#: Maximum number of pixels of a visibility buffer: 12 bytes each, and 8 where colored surfaces are transparent.
MAX_FINE_PIXELS = 1 << 25


def van_der_corput(indices: np.ndarray) -> np.ndarray:
    """Elements (N,) of the sequence with these indices, in [0,1): radical inverses in base 2."""
    digits = np.unpackbits(indices.astype(">u4")[:, None].view(np.uint8), axis=1)
    return digits @ 0.5 ** np.arange(32.0, 0.0, -1.0)


def lattice(indices: np.ndarray) -> np.ndarray:
    """(N,2): points of the lattice in [0,1), the first in the middle."""
    return np.mod(van_der_corput(indices)[:, None] * (1, LATTICE_GENERATOR) + 0.5, 1.0)


@lru_cache(maxsize=64)
def pixel_grid(index: int, count: int) -> PixelGrid:
    """The grid of samples index * count … (index + 1) * count - 1. Sample 0 is at the pixel's centre."""
    fine_from_pixel = np.array(PIXEL_GRIDS[count])
    offsets = lattice(np.arange(index * count, (index + 1) * count)) - 0.5
    texels = np.rint((offsets - offsets[0]) @ fine_from_pixel.T).astype(int)
    return PixelGrid(fine_from_pixel, offsets[0], texels, offsets)


def samples_per_visibility_buffer(width: int, height: int, samples: int, limit: int) -> int:
    """How many samples share one visibility buffer, which has that many pixels per pixel of the image.

    `limit`: the largest number of its columns and rows.
    """
    for count in sorted((count for count in PIXEL_GRIDS if count <= samples), reverse=True):
        size = pixel_grid(0, count).max_size(width, height)
        if size.max() <= limit and size.prod() <= MAX_FINE_PIXELS:
            return count
    return 1


def filter_margin(radius: float) -> int:
    """Maximum distance in pixels at which samples have weight. They lie up to half a pixel from their pixel's centre.

    If it is 0, the samples are distributed according to the filter, and have equal weights.
    """
    return max(math.ceil(radius - 0.5), 0)


def has_wide_filter(radius: float) -> bool:
    """Whether a pixel filter of this radius, px, is so wide that it is applied along rows, then along columns."""
    return filter_margin(radius) >= WIDE_MARGIN


@cache
def cumulative_filter() -> tuple[np.ndarray, np.ndarray]:
    """The Blackman-Harris filter of radius 1 (Harris 1978): its integral up to each position, and the positions."""
    position = np.linspace(-1.0, 1.0, 257)
    k = np.pi * (position + 1.0)
    weight = 0.35875 - 0.48829 * np.cos(k) + 0.14128 * np.cos(2 * k) - 0.01168 * np.cos(3 * k)
    return (np.cumsum(weight) - 0.5 * weight) / weight.sum(), position


def filtered(uniform: np.ndarray, radius: float) -> np.ndarray:
    """Offsets, px, distributed like the Blackman-Harris filter of this radius, from numbers in [0,1)."""
    return radius * np.interp(uniform, *cumulative_filter())


def subpixel_offsets(indices: np.ndarray, radius: float) -> np.ndarray:
    """(N,2) px: offsets of samples that share no grid. See filter_margin for how a filter's radius distributes them."""
    positions = np.mod(lattice(indices) + 0.5 / len(indices), 1.0)  # so that those of a sample are about its middle
    return positions - 0.5 if filter_margin(radius) else filtered(positions, radius)


def narrow_pixel_grid(sample: int, width: float) -> PixelGrid:
    """The grid of one sample, distributed like the Blackman-Harris filter of radius `width` ≤ 0.5 px."""
    offset = filtered(draw(Dimension.PIXEL, sample=sample - 1), width)  # of the first sample, the centre
    return PixelGrid(np.eye(2, dtype=int), offset, np.zeros((1, 2), int), offset[None])
