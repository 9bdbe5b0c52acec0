# SPDX-License-Identifier: GPL-3.0-or-later
"""Points on triangles, on lights and in pixels: low-discrepancy, and the same for the same input."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from functools import lru_cache

import numpy as np

from ..parallel import parallel_map

#: Points are made in blocks of this many, so that several cores share them.
POINTS_AT_A_TIME = 1 << 17


def rd_sequence(first: int, count: int, dimensions: int) -> np.ndarray:
    """(count, dimensions) float64 in [0,1): members first … of the R_d sequence.

    Generalised golden ratios (Roberts 2018): every run of neighbours is evenly spread, so any prefix and
    any slice is itself a good set.
    """
    return members(rd_increments(dimensions), first, count)


def rd_increments(dimensions: int) -> tuple[float, ...]:
    """The increments of R_d."""
    root = 1.5
    for _ in range(64):
        root = (1.0 + root) ** (1.0 / (dimensions + 1))
    return tuple(root ** -np.arange(1.0, dimensions + 1))


def members(steps: tuple[float, ...], first: int, count: int) -> np.ndarray:
    """(count, d) float64 in [0,1): members first … of the additive sequence with increments `steps` (d,)."""
    return np.modf(0.5 + np.outer(np.arange(first + 1, first + 1 + count, dtype=np.float64), steps))[0]


class Dimension(Enum):
    """What is decided by random numbers that change from sample to sample: each by increments of its own.

    Two decisions by the same numbers would follow each other: a tile that takes part in every other sample, say, would
    only ever see half of an occlusion pattern. In one dimension they are quadratic irrationals with small partial
    quotients, which are as even as the golden ratio up to a factor of two. Of rd_increments(4), three times the first
    is almost the second of rd_increments(2).
    """

    TILE_TURN = rd_increments(1)  # whether a tile takes part
    RETEST_TURN = ((13**0.5 - 3.0) / 2.0,)  # which hidden lights are looked for again, and where
    OCCLUSION_TURN = (3**0.5 - 1.0,)  # the pattern of ambient occlusion
    PIXEL = rd_increments(2)  # the place in the pixel, where samples do not share a grid
    VIRTUAL_LIGHT = rd_increments(3)[:2]  # the shift of a light's virtual point lights
    RETEST_POINT = rd_increments(4)[2:]  # the point on the light that is looked for


def sequence(dimension: Dimension, first: int, count: int) -> np.ndarray:
    """(count, d) float64 in [0,1): members first … of a decision's own sequence."""
    return members(dimension.value, first, count)


def fixed_point(numbers: Iterable[float]) -> tuple[int, ...]:
    """Of numbers in [0,1), 32-bit fixed point: sums wrap as they should, and never lose digits."""
    return tuple(round(number * 2**32) % 2**32 for number in numbers)


def barycentric(squares: np.ndarray) -> np.ndarray:
    """Uniform barycentric coordinates (N,3) of points (N,2) of the unit square.

    The square's upper half is folded onto the lower one. The report's listing 1 ends in a slip
    (1 - t2 - t3); the third coordinate is 1 - t1 - t2.
    """
    folded = np.where(squares.sum(1, keepdims=True) > 1.0, 1.0 - squares, squares)
    return np.column_stack([folded, 1.0 - folded.sum(1)])


def triangle_areas(corners: np.ndarray) -> np.ndarray:
    """(T,) m² of triangles (T,3,3)."""
    edges = corners[:, 1:] - corners[:, :1]
    return 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)


def proportional_counts(weights: np.ndarray, count: int) -> np.ndarray:
    """(N,) int64 that sum to `count`, in proportion to `weights` (N,), each within 1 of its due."""
    total = weights.sum()
    if total <= 0.0:
        return np.zeros(len(weights), np.int64)
    edges = np.floor(np.cumsum(weights) / total * count + 0.5).astype(np.int64)
    edges[-1] = count
    return np.diff(edges, prepend=0)


def points_on_triangles(corners: np.ndarray, count: int, first: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Triangle index (count,) and position (count,3) of points `first` … of a mesh's endless sequence.

    Triangles (T,3,3) are chosen with probability in proportion to their area, points uniformly on each:
    one dimension of the sequence chooses the triangle, two the point on it.
    """
    cumulative = np.cumsum(triangle_areas(corners))

    def block(start: int) -> tuple[np.ndarray, np.ndarray]:
        random = rd_sequence(first + start, min(POINTS_AT_A_TIME, count - start), 3)
        chosen = np.searchsorted(cumulative, random[:, 0] * cumulative[-1], side="right")
        chosen = np.minimum(chosen, len(corners) - 1)
        return chosen, np.einsum("nk,nkc->nc", barycentric(random[:, 1:]), corners[chosen])

    blocks = parallel_map(block, range(0, count, POINTS_AT_A_TIME), count)
    return np.concatenate([b[0] for b in blocks]), np.concatenate([b[1] for b in blocks])


def disk(squares: np.ndarray) -> np.ndarray:
    """Points (N,2) of the unit square to the disk of diameter 1, equal areas (Shirley & Chiu 1997)."""
    x, y = (2.0 * squares - 1.0).T
    wide = np.abs(x) > np.abs(y)
    radius = np.where(wide, x, y)
    minor = np.where(wide, y, x)
    angle = (np.pi / 4.0) * np.divide(minor, radius, out=np.zeros_like(radius), where=radius != 0.0)
    angle = np.where(wide, angle, np.pi / 2.0 - angle)
    return 0.5 * radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])


def lattice(count: int, shift: np.ndarray) -> np.ndarray:
    """(count,2) in [0,1): a rank-1 lattice; `shift` (2,) in [0,1) moves it (Cranley & Patterson 1976).

    It is better spread than a prefix of an endless sequence, for exactly `count` points.
    """
    golden = rd_sequence(0, count, 1)[:, 0]
    return np.modf(np.column_stack([(np.arange(count) + 0.5) / count, golden]) + shift)[0]


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

#: Steps of a ray's place on its light, from a pixel's ray to its next one, and from pixel to pixel in the order of
#: pixel_member in shadow_ray.glsl. Close to those of the additive sequence, but even together with the places in the
#: pixel, which say how much a ray counts, and over neighbours, and for thousands of rays: found by search among
#: half-seen lights, see tests/unit/direct/test_ray_sampling.py, and by the error of penumbrae, see
#: tests/stress/pictures/test_closed_forms.py.
RAY_INCREMENTS = (0.72359394, 0.59242966)
PIXEL_INCREMENTS = (0.56283799, 0.75252225)

#: Steps of when it is a pixel's turn to have a ray: from pixel to pixel, and from round to round of places in a pixel.
TURN_INCREMENTS = (2**0.5 - 1.0, (21**0.5 - 3.0) / 2.0)

#: And from light to light: of the place, of a pixel's turn, and of a tile's.
LIGHT_INCREMENTS = rd_increments(4)


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
    place = sequence(Dimension.PIXEL, number - 1, 1)[0] if number else np.full(2, 0.5)
    off = reach * np.interp(place * weight.sum(), cumulative, t)
    return PixelGrid(np.eye(2, dtype=int), off, np.zeros((1, 2), int), off[None])
