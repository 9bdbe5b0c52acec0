# SPDX-License-Identifier: GPL-3.0-or-later
"""Portals: openings through which most of the world's light reaches an interior, found by rays.

Rays that leave the scene leave the box around what is visible. Where they cross its faces, rectangles are fitted to
them. The world is then sampled through these, as through the portals that artists place (Bitterli, Novák & Jarosz
2015).
"""

import math
from dataclasses import dataclass

import numpy as np

from .portal_geometry import MEASURING_RAYS, Rays, Rectangle

#: Rectangles at most: the density of a sample takes time in proportion to their number.
MAX_PORTALS = 4

#: Unoccluded rays with fewer of which no openings are looked for. An opening has at least this many, too.
MIN_RAYS = 16

#: Where more of the rays are unoccluded, it is not indoors. Cells of that many along the longest side of the box.
MAX_INDOORS_VISIBILITY = 0.4
CELLS = 6

#: By how far an origin may be outside of the box, relative to its longest side.
BOX_MARGIN = 1e-3

#: The box's angle about z: so many are tried up to a right angle, then around the best one.
ANGLES = 18

#: Cells of a face along each side. A cell with rays is part of an opening if it has this fraction of such cells' mean.
FACE_CELLS = 12
MIN_DENSITY = 0.1

#: Fractions of an opening's rays that a rectangle is tried without, at each of its sides.
LEFT_OUT = 0.0, 0.02

#: How far in front of a face openings may be, relative to the box.
OFFSETS = 0.0, 0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0

#: Ratio of the variance of samples without portals to that with them, below which they do not pay.
MIN_GAIN = 2.0

#: Probability of a sample through a portal, at most: the others find light that portals miss.
MAX_PROBABILITY = 0.9


@dataclass(frozen=True)
class Portals:
    """Rectangles, and how samples through them are distributed."""

    rectangles: tuple[Rectangle, ...]
    crossed: float  # fraction of the rays, which are distributed as the unshadowed light is
    arriving: float  # fraction of these that are unoccluded
    missed: float  # fraction of the unoccluded rays that cross none
    unevenness: float = 1.0  # of what arrives through them: the mean square over the square of the mean

    @classmethod
    def of(cls, rectangles: tuple[Rectangle, ...], rays: Rays) -> "Portals":
        """Measured by rays that are distributed as the unshadowed light is."""
        crossed = np.any([each.crossed_by(rays) for each in rectangles], axis=0)
        found = int((crossed & rays.unoccluded).sum())
        missed = 1.0 - found / (int(rays.unoccluded.sum()) + 2.0)  # not 0 if all rays cross any
        fraction = rays.fraction(crossed)
        arriving = rays.fraction(crossed & rays.unoccluded) / fraction if fraction > 0.0 else 0.0
        return cls(rectangles, fraction, arriving, missed, rays.unevenness(crossed))

    @property
    def relative_deviations(self) -> tuple[float, float]:
        """Of light through them and beside them, if rays are distributed as light is, relative to that of all light."""
        through = (1.0 - self.missed) * self.crossed * self.unevenness
        return float(np.sqrt(through)), float(np.sqrt(self.missed))

    @property
    def gain(self) -> float:
        """Ratio of the variance of samples without portals to that of the probability below."""
        return 1.0 / sum(self.relative_deviations) ** 2

    @property
    def probability(self) -> float:
        """Of a sample through any: the one of which the second moment (1 - m) c / p + m / (1 - p) is the least."""
        through, beside = self.relative_deviations
        return min(through / (through + beside), MAX_PROBABILITY)

    @property
    def moments(self) -> tuple[float, float]:
        """Of a ray's visibility, the second moment: factors of the visibility's square, and of itself."""
        return 1.0 / (max(self.arriving, 1e-3) * self.probability), self.missed / (1.0 - self.probability)

    @property
    def importance_beside(self) -> float:
        """Of a ray that crosses none, relative to one that does: the root of the ratio of their visibilities."""
        through, beside = (1.0 - self.missed) * (1.0 - self.crossed), self.missed * self.crossed
        return min(math.sqrt(beside / max(through, beside)), 1.0)


def find_portals(rays: Rays) -> Portals | None:
    """Portals from rays that are distributed as the unshadowed light is; None if none pay."""
    if rays.unoccluded.sum() < MIN_RAYS:
        return None
    axes = box_axes(rays.origins[:: max(len(rays) // MEASURING_RAYS, 1)])
    rays = rays[are_indoors(rays, axes)]
    if rays.unoccluded.sum() < MIN_RAYS:
        return None
    low, high = box(rays.origins, axes)
    rays = rays[are_inside(rays.origins, axes, low, high)].fewer  # without those that start in an opening
    unoccluded, occluded = rays[rays.unoccluded], rays[~rays.unoccluded]
    openings: list[tuple[int, Rectangle]] = []
    face = faces_crossed(unoccluded, axes, low, high)
    for index in range(6):
        for opening in openings_of_face(unoccluded[face == index], index, axes, low, high):
            openings.append((len(opening), best_rectangle(opening, occluded, index, axes, low, high)))
    openings.sort(key=lambda each: -each[0])
    best: Portals | None = None
    for _, rectangle in openings:
        portals = Portals.of((*best.rectangles, rectangle) if best else (rectangle,), rays)
        if best is None or portals.gain > best.gain:
            best = extended(portals, rays)
        if len(best.rectangles) == MAX_PORTALS:
            break
    return best if best and best.gain >= MIN_GAIN else None


def extended(portals: Portals, rays: Rays) -> Portals:
    """Each rectangle extended to unoccluded rays that cross none, if that lowers the variance.

    The box is only around what is visible, so rays through a part of an opening may leave it by another face.
    """
    unoccluded = rays[rays.unoccluded]
    for index, rectangle in enumerate(portals.rectangles):
        missed = ~np.any([each.crossed_by(unoccluded) for each in portals.rectangles], axis=0)
        others = portals.rectangles[:index], portals.rectangles[index + 1 :]
        for larger in rectangle.extensions(unoccluded[missed]):
            tried = Portals.of((*others[0], larger, *others[1]), rays)
            if tried.gain > portals.gain:
                portals = tried
    return portals


def box(origins: np.ndarray, axes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Low and high corners (3,), along axes (3,3), of the box around almost all origins (N,3)."""
    low, high = np.quantile(origins @ axes.T, (0.01, 0.99), axis=0)
    return low, np.maximum(high, low + BOX_MARGIN * (high - low).max() + 1e-9)


def are_inside(origins: np.ndarray, axes: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """(N,) bool: whether origins (N,3) are in the box or on its faces."""
    along, margin = origins @ axes.T, BOX_MARGIN * (high - low).max()
    inside: np.ndarray = ((along >= low - margin) & (along <= high + margin)).all(1)
    return inside


def box_axes(origins: np.ndarray) -> np.ndarray:
    """Rows (3,3): the axes, turned about z, along which the box around origins (N,3) has the least base."""
    angle, step = 0.0, 0.5 * np.pi
    for _ in range(2):
        tried = [turned(angle + step * (k / ANGLES - 0.5)) for k in range(ANGLES)]
        sizes = np.array([np.subtract(*box(origins, axes)[::-1]) for axes in tried])
        best = int(np.argmin(sizes[:, 0] * sizes[:, 1]))
        angle, step = angle + step * (best / ANGLES - 0.5), 2.0 * step / ANGLES
    return turned(angle)


def turned(angle: float) -> np.ndarray:
    """Rows (3,3): axes turned about z by an angle, rad."""
    sine, cosine = np.sin(angle), np.cos(angle)
    return np.array([[cosine, sine, 0.0], [-sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def are_indoors(rays: Rays, axes: np.ndarray) -> np.ndarray:
    """(N,) bool: whether few of the rays from the same cell are unoccluded."""
    low, high = box(rays.origins, axes)
    cells = np.floor((rays.origins @ axes.T - low) * (CELLS / (high - low).max())).astype(np.int64)
    cell = np.ravel_multi_index(np.clip(cells + 1, 0, CELLS + 1).T, (CELLS + 2,) * 3)
    indoors: np.ndarray = np.bincount(cell, rays.unoccluded) <= MAX_INDOORS_VISIBILITY * np.bincount(cell)
    return indoors[cell]


def faces_crossed(rays: Rays, axes: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """(N,) index of the face of the box by which rays leave it: of the axes' low ends, then of their high ends."""
    origins, directions = rays.origins @ axes.T, rays.directions @ axes.T
    ahead = directions > 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        distances = (np.where(ahead, high, low) - origins) / directions
    axis = np.nanargmin(np.where(directions == 0.0, np.inf, distances), axis=1)
    face: np.ndarray = axis + 3 * ahead[np.arange(len(rays)), axis]
    return face


def crossings(rays: Rays, face: int, axes: np.ndarray, level: float) -> np.ndarray:
    """(N,2): where rays cross the plane of a face at `level` along its axis, in coordinates of the other axes."""
    axis, others = face % 3, [k for k in range(3) if k != face % 3]
    origins, directions = rays.origins @ axes.T, rays.directions @ axes.T
    along = directions[:, axis]
    distances = (level - origins[:, axis]) / np.where(np.abs(along) > 1e-6, along, 1e-6)
    points: np.ndarray = (origins + distances[:, None] * directions)[:, others]
    return points


def openings_of_face(rays: Rays, face: int, axes: np.ndarray, low: np.ndarray, high: np.ndarray) -> list[Rays]:
    """The rays of each opening: of connected cells of a face that rays leave the box by."""
    if len(rays) < MIN_RAYS:
        return []
    axis, others = face % 3, [k for k in range(3) if k != face % 3]
    points = crossings(rays, face, axes, float((low, high)[face // 3][axis]))
    cells = (points - low[others]) / (high - low)[others] * FACE_CELLS
    cells = np.clip(cells.astype(np.int64), 0, FACE_CELLS - 1)
    counts = np.zeros((FACE_CELLS, FACE_CELLS), np.int64)
    np.add.at(counts, tuple(cells.T), 1)
    dense = counts >= MIN_DENSITY * counts[counts > 0].mean()
    labels = np.where(dense, np.arange(1, FACE_CELLS**2 + 1).reshape(counts.shape), 0)
    for _ in range(FACE_CELLS**2):
        spread = np.lib.stride_tricks.sliding_window_view(np.pad(labels, 1), (3, 3)).max((2, 3)) * dense
        if (spread == labels).all():
            break
        labels = spread
    label = labels[tuple(cells.T)]
    openings = [rays[label == each] for each in np.unique(label[label > 0])]
    return [each for each in openings if len(each) >= MIN_RAYS]


def best_rectangle(
    rays: Rays, occluded: Rays, face: int, axes: np.ndarray, low: np.ndarray, high: np.ndarray
) -> Rectangle:
    """Of rectangles that most rays of an opening cross, at any of OFFSETS from a face, the one with the most gain."""
    axis, others = face % 3, [k for k in range(3) if k != face % 3]
    outwards = 1.0 if face >= 3 else -1.0
    both = rays.with_others(occluded)
    tried = []
    for offset in OFFSETS:
        level = float((low, high)[face // 3][axis] + outwards * offset * (high - low)[axis])
        points = crossings(rays, face, axes, level)
        for left_out in LEFT_OUT:
            first, last = np.quantile(points, (left_out, 1.0 - left_out), axis=0)
            margin = (last - first) / len(rays)
            first, last = first - margin, last + margin
            centre = np.zeros(3)
            centre[axis], centre[others] = level, 0.5 * (first + last)
            sides = (last - first)[:, None] * axes[others]
            tried.append(Portals.of((Rectangle(centre @ axes, sides, -outwards * axes[axis]),), both))
    return max(tried, key=lambda each: each.gain).rectangles[0]
