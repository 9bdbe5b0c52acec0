# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarse tiles: their bounds contain those of their tiles."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.culling.hidden_lights import (
    COARSE_SIDE,
    coarse_tiles_of,
    over_coarse_tiles,
    surfaces_of_coarse_tiles,
)
from ism_addon.gpu.culling.surface_bounds import SurfaceBounds
from ism_addon.gpu.tiles import repeated

TILES = [(1, 1), (4, 4), (9, 6), (5, 13)]


@pytest.mark.parametrize("tiles", TILES, ids=str)
def test_surfaces_of_coarse_tiles_contain_those_of_their_tiles(tiles):
    columns, rows = tiles
    random, count = np.random.default_rng(columns), 2 * columns * rows
    low = random.normal(size=(3, count)).astype(np.float32)
    axis = random.normal(size=(3, count)).astype(np.float32)
    surfaces = SurfaceBounds(
        random.random(count) < 0.7,
        low,
        low + random.random((3, count), np.float32),
        axis / np.linalg.norm(axis, axis=0),
        0.5 * random.random(count, np.float32),
    )
    coarse = surfaces_of_coarse_tiles(surfaces, tiles)
    coarse_columns, coarse_rows = coarse_tiles_of(tiles)
    row, column = np.indices((rows, columns)) // COARSE_SIDE
    own = (row * coarse_columns + column).ravel()
    own = np.concatenate([own, coarse_columns * coarse_rows + own])
    assert len(coarse.exists) == 2 * coarse_columns * coarse_rows
    wider = replace(coarse, half_angle=coarse.half_angle + np.float32(1e-3))  # the arccos of 1 - 1e-7 is 5e-4
    assert wider.select(own).contains(surfaces).all()
    for tile in range(len(coarse.exists)):
        assert coarse.exists[tile] == surfaces.exists[own == tile].any()


@pytest.mark.parametrize("tiles", TILES, ids=str)
def test_values_of_coarse_tiles_and_of_their_tiles(tiles):
    values = np.random.default_rng(0).random(tiles[::-1])
    sums, greatest = over_coarse_tiles(np.add, values), over_coarse_tiles(np.maximum, values)
    assert sums.shape == greatest.shape == coarse_tiles_of(tiles)[::-1]
    assert sums.sum() == pytest.approx(values.sum())
    assert (repeated(greatest, COARSE_SIDE, tiles) >= values).all()
    assert greatest.max() == values.max()
