# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of a map of all directions: its irradiance by normal, and nodes of a quadtree by which directions are sampled.

The quadtree's square is an octahedron (Cigolle et al. 2014). A direction's density is in proportion to the product of
the map's luminance and the cosine at the receiver (Clarberg et al. 2005; 2008): the coarse levels have a table for each
of MAP_NORMALS × MAP_NORMALS normals, the fine ones are of the luminance alone. The density is exact, so samples are
unbiased; and neighboring random numbers give neighboring directions, so strata are kept.
"""

from dataclasses import dataclass
from functools import cache
from typing import Self

import numpy as np

from ..gl.shader_records import directions_from_octahedron, octahedron_from_directions
from .equirectangular import coordinates, interpolated, reduced, texel_directions

#: Normals along a side of their square. Levels of the quadtree that depend on the normal, and all levels.
MAP_NORMALS, COARSE_LEVELS, ALL_LEVELS = 32, 4, 8
#: Cells along a side of the square of normals, at whose corners the irradiance is known.
IRRADIANCE_CELLS = 128
GLSL_CONSTANTS = {
    "map_normals": MAP_NORMALS,
    "coarse_levels": COARSE_LEVELS,
    "all_levels": ALL_LEVELS,
    "irradiance_cells": IRRADIANCE_CELLS,
}

#: Cells along a side of the square of directions, for which cosines are evaluated; points along a side of a leaf.
COSINE_CELLS, LEAF_POINTS = 64, 2
#: The least sum of a leaf, relative to the mean: a black one may have light at its edge.
MIN_LEAF = 1e-3
#: Columns of the map whose texels are summed.
SUMMED_COLUMNS = 1024
#: Normals whose irradiance is computed at a time: few enough for the processor's cache, and for OpenBLAS to multiply
#: their matrices in one thread (up to 2^18 products). Where other threads have the cores, as Blender's and drivers' do,
#: each multiplication by several would wait for its turn: 9.4 s instead of 0.4.
NORMALS_AT_ONCE = 20
#: Added to cosines: more than the sine of the angle by which a normal and a direction differ from their cells' middles.
MARGIN = 0.12


@dataclass(frozen=True, eq=False)
class MapTables:
    """Tables of a map, in units of `peak`."""

    peak: float  # W/(sr m²): the radiance from everywhere that would light a surface as much as the map does at most
    irradiance: np.ndarray  # ((IRRADIANCE_CELLS + 1)²,3) float32, by normal
    product: np.ndarray  # (N,4) float32: for each normal all nodes of the coarse levels, sums of their four children
    fine: np.ndarray  # (N,4) float32: nodes of the fine levels
    leaves: np.ndarray  # (S,S) float32: what their children are

    @classmethod
    def of(cls, radiance: np.ndarray, luminance: np.ndarray) -> Self:
        """Of a map (H,W,3); `luminance` (3,) of the working space's primaries."""
        radiance = reduced(radiance.astype(np.float32, copy=False), SUMMED_COLUMNS)
        colors, middles = sums_of_cells(radiance, luminance.astype(np.float32))
        irradiance = irradiance_table(colors, middles)
        peak = max(float((irradiance @ luminance).max()) / np.pi, 1e-30)
        weights, places = leaf_points()
        relative = radiance @ (luminance / peak).astype(np.float32)
        light = weights * np.maximum(interpolated(relative, places), 0.0)
        side = 1 << ALL_LEVELS
        leaves = light.reshape(side, LEAF_POINTS, side, LEAF_POINTS).sum((1, 3))
        leaves += np.float32(MIN_LEAF) * leaves.mean()
        cosines = unit_vectors(middles_of(MAP_NORMALS)) @ unit_vectors(middles_of(COSINE_CELLS)).T
        of_cells = halved(leaves[None], (side // COSINE_CELLS).bit_length() - 1).reshape(-1)
        products = np.maximum(cosines + np.float32(MARGIN), 0.0) * of_cells
        coarse = halved(products.reshape(-1, COSINE_CELLS, COSINE_CELLS), COSINE_CELLS.bit_length() - 1 - COARSE_LEVELS)
        return cls(
            peak,
            (irradiance / peak).astype(np.float32),
            np.concatenate(nodes(coarse, 0), 1).reshape(-1, 4).astype(np.float32),
            np.concatenate(nodes(leaves[None], COARSE_LEVELS), 1)[0].astype(np.float32),
            leaves.astype(np.float32),
        )


def directions_by_light(leaves: np.ndarray, squares: np.ndarray) -> np.ndarray:
    """(N,3) unit vectors, as many as each of the leaves (S,S) has light, for `squares` (N,2) in [0,1).

    Descends the quadtree as environment.glsl does, so that strata of squares are strata of directions.
    """
    levels = [leaves.astype(np.float64)]
    while len(levels[-1]) > 1:
        levels.append(halved(levels[-1][None])[0])
    u, v = squares.T.astype(np.float64)
    column, row = np.zeros((2, len(squares)), np.int64)
    for sums in levels[-2::-1]:
        column, row = 2 * column, 2 * row
        children = np.stack([sums[row + y, column + x] for y in (0, 1) for x in (0, 1)])
        right, u = halves_by_weight(children[0] + children[2], children[1] + children[3], u)
        left, above = np.where(right, children[1::2], children[::2])
        up, v = halves_by_weight(left, above, v)
        column, row = column + right, row + up
    points = (np.stack([column + u, row + v], 1) / len(leaves)) * 2.0 - 1.0
    return directions_from_octahedron(points)


def halves_by_weight(first: np.ndarray, second: np.ndarray, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which half (N,) a number in [0,1) falls in, True for the second, and where in it, of halves of these weights."""
    split = first / np.maximum(first + second, 1e-300)
    is_second = at >= split
    within = np.where(is_second, (at - split) / np.maximum(1.0 - split, 1e-300), at / np.maximum(split, 1e-300))
    return is_second, np.clip(within, 0.0, np.nextafter(1.0, 0.0))


@cache
def leaf_points() -> tuple[np.ndarray, np.ndarray]:
    """Points evenly distributed in the square: their solid angles (P,) float32 sr, and coordinates (P,2) in a map."""
    count = LEAF_POINTS << ALL_LEVELS
    directions = unit_vectors(middles_of(count))
    size = np.abs(directions).sum(1)
    return (4.0 * size**3 / count**2).astype(np.float32), coordinates(directions)


@cache
def texels(height: int, width: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of a map's texels (P,): unit vectors (P,3), solid angles (P,1) sr, and cells, of COSINE_CELLS along a side."""
    directions, solid_angles = texel_directions(height, width)
    points = 0.5 * octahedron_from_directions(directions) + 0.5
    column, row = np.minimum((points * COSINE_CELLS).astype(np.int64), COSINE_CELLS - 1).T
    return directions, solid_angles, row * COSINE_CELLS + column


def sums_of_cells(radiance: np.ndarray, luminance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """For each cell of directions, of a map (H,W,3): the irradiance (C,3) of a surface that faces it, and its middle.

    This (C,3) is the mean of directions, weighted by luminance. It is shorter than a unit vector.
    """
    directions, solid_angles, cell = texels(*radiance.shape[:2])
    colors = radiance.reshape(-1, 3) * solid_angles
    light = np.maximum(colors @ luminance, 0.0)
    columns = *colors.T, light, *(directions * light[:, None]).T
    sums = np.stack([np.bincount(cell, column, COSINE_CELLS**2) for column in columns], 1).astype(np.float32)
    return sums[:, :3], sums[:, 4:] / np.maximum(sums[:, 3:4], 1e-30)


def irradiance_table(colors: np.ndarray, middles: np.ndarray) -> np.ndarray:
    """((IRRADIANCE_CELLS + 1)²,3): the irradiance of all normals, by cells: see sums_of_cells.

    That of opposite normals differs by the normal's product with the sum of all light, a vector, so half are computed.
    """
    normals = unit_vectors(np.linspace(-1.0, 1.0, IRRADIANCE_CELLS + 1))
    up = normals[:, 2] >= 0.0
    irradiance = np.zeros_like(normals)
    irradiance[up] = irradiance_of(normals[up], colors, middles)
    points = octahedron_from_directions(-normals[~up])
    column, row = np.rint((0.5 * points + 0.5) * IRRADIANCE_CELLS).astype(np.int64).T
    opposite = irradiance[row * (IRRADIANCE_CELLS + 1) + column]
    irradiance[~up] = np.maximum(opposite + normals[~up] @ (middles.T @ colors), 0.0)
    return irradiance


def irradiance_of(normals: np.ndarray, colors: np.ndarray, middles: np.ndarray) -> np.ndarray:
    """(N,3) irradiance of normals (N,3) by cells: see sums_of_cells.

    The horizon cuts cells. So the cosines of a cell's directions count as evenly distributed around that of its middle.
    """
    widths = np.sqrt(np.maximum(1.5 * (1.0 - (middles * middles).sum(1)), 1e-12)).astype(np.float32)
    per_width, irradiance = 1.0 / (4.0 * widths), []
    # One after the other: with several threads, each of these short steps would wait for another's to end.
    for first in range(0, len(normals), NORMALS_AT_ONCE):
        cosines = normals[first : first + NORMALS_AT_ONCE] @ middles.T
        beyond = widths - np.abs(cosines)
        np.maximum(beyond, 0.0, out=beyond)
        beyond *= beyond
        beyond *= per_width
        np.maximum(cosines, 0.0, out=cosines)
        cosines += beyond
        irradiance.append(cosines @ colors)
    return np.concatenate(irradiance)


def middles_of(count: int) -> np.ndarray:
    """(count,): the middles of equal parts of -1 to 1."""
    return (np.arange(count) + 0.5) / (0.5 * count) - 1.0


def unit_vectors(positions: np.ndarray) -> np.ndarray:
    """(N²,3) float32 at all pairs of positions (N,) from -1 to 1 along the square's sides."""
    points = np.stack(np.meshgrid(positions, positions), -1).reshape(-1, 2)
    return directions_from_octahedron(points).astype(np.float32)


def halved(sums: np.ndarray, times: int = 1) -> np.ndarray:
    """(K,S,S) sums of squares of cells, with half as many cells along each side, as often."""
    for _ in range(times):
        rows = sums[:, 0::2] + sums[:, 1::2]
        sums = rows[..., 0::2] + rows[..., 1::2]
    return sums


def nodes(sums: np.ndarray, first_level: int) -> list[np.ndarray]:
    """(K,N,4): for each level from `first_level` on, all nodes' sums of their children, of leaves (K,S,S)."""
    levels = []
    while sums.shape[1] > 1 << first_level:
        count, side = len(sums), sums.shape[1] // 2
        children = sums.reshape(count, side, 2, side, 2).swapaxes(2, 3).reshape(count, side * side, 4)
        levels.append(children)
        sums = halved(sums)
    return levels[::-1]
