# SPDX-License-Identifier: GPL-3.0-or-later
"""Emissive triangles whose radiance varies, split to pieces of about even radiance.

A triangle is split at the middles of its edges, and its parts again. It is evaluated at a point in each of the smallest
parts. Parts whose radiance hardly differs are kept together, from the smallest ones up.
"""

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from ...sampling.dimensions import Dimension, draw

#: Parts of a triangle that is split once.
PARTS = 4

#: The largest difference of radiance between parts that are kept together, relative to their own radiance or to that of
#: the light, if that is more.
MAX_DIFFERENCE = 0.02


class Pieces(NamedTuple):
    """Pieces of a mesh's triangles, each of even radiance."""

    triangle: np.ndarray  # (P,) int
    radiance: np.ndarray  # (P,3) W/(sr m²)
    corners: np.ndarray | None = None  # (P,3,3) barycentric; None: the whole triangles
    side: np.ndarray | None = None  # (P,) 1: the front alone emits; -1: the back; 0, or None of all: both

    @classmethod
    def joined(cls, of_mesh: Sequence["Pieces"]) -> "Pieces":
        """Several of the same mesh as one."""
        present = [each for each in of_mesh if len(each.triangle)] or of_mesh[:1]
        if len(present) == 1:
            return present[0]
        whole = np.eye(3)
        corners = [
            np.broadcast_to(whole, (len(each.triangle), 3, 3)) if each.corners is None else each.corners
            for each in present
        ]
        sides = [np.zeros(len(each.triangle), int) if each.side is None else each.side for each in present]
        triangle, radiance = (np.concatenate([each[k] for each in present]) for k in range(2))
        return cls(triangle, radiance, np.concatenate(corners), np.concatenate(sides))

    def on_side(self, side: int) -> "Pieces":
        """The same on one side alone."""
        return self._replace(side=np.full(len(self.triangle), side))


def depth_within(count: int, limit: int) -> int:
    """How often `count` triangles can be split so that they have at most `limit` parts; 0 if they are more already."""
    depth = 0
    while count * PARTS ** (depth + 1) <= limit:
        depth += 1
    return depth


@cache
def parts_at(depth: int) -> np.ndarray:
    """(PARTS**depth,3,3): barycentric corners of the parts of a triangle; those of a part follow one another."""
    if depth == 0:
        return np.eye(3)[None]
    a, b, c = np.moveaxis(parts_at(depth - 1), 1, 0)
    ab, bc, ca = (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0
    children = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    return np.stack([np.stack(each, 1) for each in children], 1).reshape(-1, 3, 3)


def points_in_parts(count: int, depth: int) -> tuple[np.ndarray, np.ndarray]:
    """A point in each part of `count` triangles, (count * PARTS**depth,3) barycentric, and a direction (…,3) for each.

    The directions are distributed by their cosine to the z axis.
    """
    corners = parts_at(depth)
    numbers = draw(Dimension.EMISSION_POINT, point=np.arange(count * len(corners)))
    root = np.sqrt(numbers[:, 0])
    weights = np.stack([1.0 - root, root * (1.0 - numbers[:, 1]), root * numbers[:, 1]], 1)
    points = np.einsum("npc,pci->npi", weights.reshape(count, -1, 3), corners).reshape(-1, 3)
    radius, angle = np.sqrt(numbers[:, 2]), 2.0 * np.pi * numbers[:, 3]
    return points, np.stack([radius * np.cos(angle), radius * np.sin(angle), np.sqrt(1.0 - numbers[:, 2])], 1)


def split(triangle: np.ndarray, light: np.ndarray, areas: np.ndarray, radiance: np.ndarray, max_pieces: int) -> Pieces:
    """Pieces of triangles (N,) of lights (N,), of their radiance (N,PARTS**depth,3) by part; without black ones.

    Those are split first whose parts differ most, by their radiance times their area, until a light has `max_pieces`,
    or as many as it has triangles. `areas`: (N,).
    """
    depth = max(radiance.shape[1].bit_length() // 2 - 1, 0)  # of pieces, each of which has PARTS points
    levels = [radiance.reshape(len(triangle), PARTS**level, -1, 3).mean(2) for level in range(depth + 1)]
    mean = light_means(light, areas, levels[0][:, 0])[light]
    gains: list[np.ndarray] = []  # of splitting a part or any of its own parts
    for level in reversed(range(depth)):
        parts = levels[level + 1].reshape(len(triangle), -1, PARTS, 3)
        differences = np.ptp(parts, axis=2).max(2)
        is_even = differences <= MAX_DIFFERENCE * np.maximum(levels[level], mean[:, None]).max(2)
        own = np.where(is_even, 0.0, differences * areas[:, None] / PARTS**level)
        if gains:
            own = np.maximum(own, gains[0].reshape(len(triangle), -1, PARTS).max(2))
        gains.insert(0, own)
    thresholds = gain_thresholds(light, gains, max_pieces)[light, None]
    found, exists = list[Pieces](), np.ones((len(triangle), 1), bool)
    for level, values in enumerate(levels):
        is_split = exists & (gains[level] > thresholds) if level < depth else np.zeros_like(exists)
        row, part = np.nonzero(exists & ~is_split & values.any(2))
        found.append(Pieces(triangle[row], values[row, part], parts_at(level)[part]))
        exists = is_split.repeat(PARTS, 1)
    return Pieces.joined(found)


def light_means(light: np.ndarray, areas: np.ndarray, radiance: np.ndarray) -> np.ndarray:
    """(L,3): means over the areas (N,) of lights (N,)."""
    sums = np.stack([np.bincount(light, areas * column) for column in radiance.T], 1)
    means: np.ndarray = sums / np.maximum(np.bincount(light, areas), 1e-300)[:, None]
    return means


def gain_thresholds(light: np.ndarray, gains: list[np.ndarray], max_pieces: int) -> np.ndarray:
    """(L,): what the gain (N,…) of splitting a part must exceed, so that lights (N,) have at most so many pieces."""
    counts = np.bincount(light)
    thresholds, lights = (
        np.zeros(len(counts)),
        np.concatenate([light.repeat(each.shape[1]) for each in gains] or [light]),
    )
    values = np.concatenate([each.ravel() for each in gains] or [np.zeros(len(light))])
    order = np.lexsort([-values, lights])
    first = np.searchsorted(lights[order], np.arange(len(counts)))
    last = np.append(first[1:], len(order)) - 1
    splits = np.maximum(max_pieces - counts, 0) // (PARTS - 1)  # each makes so many pieces more
    thresholds = values[order[np.minimum(first + splits, last)]]
    return np.where(first + splits > last, 0.0, thresholds)
