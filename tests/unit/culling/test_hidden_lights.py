# SPDX-License-Identifier: GPL-3.0-or-later
"""Blocks of tiles: their bounds contain those of their tiles."""

from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.culling.hidden_lights import BLOCK_SIDE, blocks_of, of_tiles, over_blocks, surfaces_of_blocks
from ism_addon.gpu.culling.surface_bounds import SurfaceBounds

TILES = [(1, 1), (4, 4), (9, 6), (5, 13)]


@pytest.mark.parametrize("tiles", TILES, ids=str)
def test_surfaces_of_blocks_contain_those_of_their_tiles(tiles):
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
    blocks = surfaces_of_blocks(surfaces, tiles)
    block_columns, block_rows = blocks_of(tiles)
    row, column = np.indices((rows, columns)) // BLOCK_SIDE
    own = (row * block_columns + column).ravel()
    own = np.concatenate([own, block_columns * block_rows + own])
    assert len(blocks.exists) == 2 * block_columns * block_rows
    wider = replace(blocks, half_angle=blocks.half_angle + np.float32(1e-3))  # the arccos of 1 - 1e-7 is 5e-4
    assert wider.select(own).contains(surfaces).all()
    for block in range(len(blocks.exists)):
        assert blocks.exists[block] == surfaces.exists[own == block].any()


@pytest.mark.parametrize("tiles", TILES, ids=str)
def test_values_of_blocks_and_of_their_tiles(tiles):
    values = np.random.default_rng(0).random(tiles[::-1])
    sums, greatest = over_blocks(np.add, values), over_blocks(np.maximum, values)
    assert sums.shape == greatest.shape == blocks_of(tiles)[::-1]
    assert sums.sum() == pytest.approx(values.sum())
    assert (of_tiles(greatest, tiles) >= values).all()
    assert greatest.max() == values.max()
