# SPDX-License-Identifier: GPL-3.0-or-later
"""What the models of scattering share: phase functions, the geometry of the atmosphere, and tables."""

import numpy as np
import pytest

from ism_addon.shading.sky import phase, table
from ism_addon.shading.sky.atmosphere import Atmosphere

COSINES, WEIGHTS = np.polynomial.legendre.leggauss(64)
EARTH = Atmosphere(6360e3, 60e3)


@pytest.mark.parametrize(
    "values",
    [phase.rayleigh(COSINES), phase.henyey_greenstein(COSINES, 0.8), phase.cornette_shanks(COSINES, 0.76)],
)
def test_phase_functions_scatter_all_light(values):
    assert 2.0 * np.pi * WEIGHTS @ values == pytest.approx(1.0, abs=1e-6)


def test_the_mean_cosine_of_henyey_and_greenstein():
    values = phase.henyey_greenstein(COSINES, 0.6)
    assert 2.0 * np.pi * (WEIGHTS * COSINES) @ values == pytest.approx(0.6, abs=1e-6)


def test_heights_are_precise_in_single_precision():
    heights = np.float32([0.0, 0.125, 10.0, 59999.0])
    assert np.allclose(EARTH.height(EARTH.squared(heights)), heights, rtol=1e-6)


def test_the_way_into_space():
    height = 1000.0
    radius, squared = EARTH.radius + height, EARTH.squared(height)
    for sine, distance in ((1.0, 59e3), (-1.0, 59e3 + 2.0 * radius)):
        assert EARTH.to_space(squared, np.array(radius * sine)) == pytest.approx(distance, abs=1e-3)
    along = np.array(radius * 0.5)
    end = EARTH.onward(squared, along, EARTH.to_space(squared, along))
    assert EARTH.height(end) == pytest.approx(EARTH.thickness, abs=1e-3)


def test_tables_are_interpolated_linearly_up_to_their_edges():
    rows, columns = np.float32([0.0, 1.0, 4.0])[:, None], np.float32([0.0, 2.0])
    values = (rows + columns)[..., None]
    at = np.array([0.5, -1.0, 1.5, 9.0]), np.array([0.0, 0.5, 2.0, 0.25])
    expected = [0.5, 1.0, 4.5, 4.5]
    assert table.sampled(values, *at)[:, 0].tolist() == expected
    assert np.diagonal(table.sampled_grid(values, *at)[..., 0]).tolist() == expected


def test_rows_are_denser_at_the_horizon():
    rows = table.row_at(np.array([-0.5 * np.pi, 0.0, 0.5 * np.pi]))
    assert rows.tolist() == [-0.5, 0.5 * table.ROWS - 0.5, table.ROWS - 0.5]
    assert table.row_at(np.array([0.01])) - rows[1] > 10.0


def test_azimuths_are_interpolated_exactly_for_cosines():
    azimuth = np.linspace(0.0, np.pi, 50)
    values = 1.0 + np.cos(3.0 * table.nodes(8)) + np.cos(7.0 * table.nodes(8))
    expected = 1.0 + np.cos(3.0 * azimuth) + np.cos(7.0 * azimuth)
    assert np.allclose(table.from_nodes(azimuth, 8) @ values, expected, atol=1e-5)
