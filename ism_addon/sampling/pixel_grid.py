# SPDX-License-Identifier: GPL-3.0-or-later
"""Where in a pixel samples lie: on a grid that several share, or spread as a narrow filter."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from .dimensions import Dimension, draw


@dataclass(frozen=True)
class PixelGrid:
    """A grid finer than the pixels', turned against them, and the places in a pixel that samples take on it."""

    fine_from_pixel: np.ndarray  # (2,2) int
    off: np.ndarray  # (2,) px: how far fine pixels' centres are off the pixels'
    texels: np.ndarray  # (N,2) int: the fine pixel of each place, from the one of the pixel's centre
    places: np.ndarray  # (N,2) px: from the pixel's centre

    def bounds(self, width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
        """(2,) each: the fine pixel of the picture's first pixel, and how many there are in all."""
        corners = np.array([[0, 0], [width - 1, 0], [0, height - 1], [width - 1, height - 1]]) @ self.fine_from_pixel.T
        first = -corners.min(0) - self.texels.min(0)
        return first, np.ptp(corners, axis=0) + np.ptp(self.texels, axis=0) + 1

    def room(self, width: int, height: int) -> np.ndarray:
        """(2,): no grid like this one has more fine pixels, whatever places it holds."""
        _, size = self.bounds(width, height)
        return size - np.ptp(self.texels, axis=0) + np.abs(self.fine_from_pixel).sum(1) + 1

    def fine_from_clip(self, width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
        """(2,2) and (2,): what turns clip coordinates x, y of the picture, and w, into those of the fine one."""
        (first, fine), size = self.bounds(width, height), np.array([width, height])
        shift = self.fine_from_pixel @ (size / 2.0 - 0.5 - self.off) + 0.5 + first
        return self.fine_from_pixel * size / fine[:, None], 2.0 * shift / fine - 1.0


#: Places in a pixel are a rank-1 lattice of this step, in van der Corput's order, so that the first 2, 4, 8, … are one
#: as well (Hickernell et al. 2000): on as many lines along the pixel's sides, where pictures are full of edges, and far
#: from each other. The step is that whose lattices of up to 4,096 places are the widest.
LATTICE_GENERATOR = 3045

#: How fine pixels lie to pixels, by the number of places that share a grid: the lattice's shortest steps are its own.
PIXEL_GRIDS = {1: [[1, 0], [0, 1]], 4: [[2, 2], [-1, 1]], 16: [[5, -1], [1, 3]]}


def van_der_corput(numbers: np.ndarray) -> np.ndarray:
    """Members (N,) of the sequence in [0,1): binary digits the other way round."""
    digits = np.unpackbits(numbers.astype(">u4")[:, None].view(np.uint8), axis=1)
    return digits @ 0.5 ** np.arange(32.0, 0.0, -1.0)


@lru_cache(maxsize=64)
def pixel_grid(number: int, count: int) -> PixelGrid:
    """A pixel's next `count` places after `number` times as many; the very first is at its centre."""
    fine_from_pixel = np.array(PIXEL_GRIDS[count])
    lattice = van_der_corput(np.arange(number * count, (number + 1) * count))[:, None] * (1, LATTICE_GENERATOR)
    places = np.mod(lattice + 0.5, 1.0) - 0.5
    texels = np.rint((places - places[0]) @ fine_from_pixel.T).astype(int)
    return PixelGrid(fine_from_pixel, places[0], texels, places)


def narrow_pixel_grid(number: int, reach: float) -> PixelGrid:
    """One place, spread as the Blackman-Harris filter that reaches `reach` px, half a pixel at most (Harris 1978)."""
    t = np.linspace(-1.0, 1.0, 257)
    k = np.pi * (t + 1.0)
    weight = 0.35875 - 0.48829 * np.cos(k) + 0.14128 * np.cos(2 * k) - 0.01168 * np.cos(3 * k)
    cumulative = np.cumsum(weight) - 0.5 * weight
    place = draw(Dimension.PIXEL, sample=number - 1)  # of the first, the middle
    off = reach * np.interp(place * weight.sum(), cumulative, t)
    return PixelGrid(np.eye(2, dtype=int), off, np.zeros((1, 2), int), off[None])
