# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of a map of all directions, beside sums over all of its texels."""

import numpy as np
import pytest

from ism_addon.color import REC709, luminance
from ism_addon.gpu.environment.equirectangular import coordinates, interpolated, reduced, texel_directions
from ism_addon.gpu.environment.map_tables import (
    ALL_LEVELS,
    COARSE_LEVELS,
    IRRADIANCE_CELLS,
    MAP_NORMALS,
    MapTables,
    directions_by_light,
    halved,
)
from ism_addon.gpu.environment.map_texture import with_mip_levels
from ism_addon.gpu.gl.shader_records import directions_from_octahedron, octahedron_from_directions
from ism_addon.sampling.points import lattice

LUMINANCE = luminance(REC709)


def random_map(height=64, width=128, power=4):
    return np.random.default_rng(0).random((height, width, 3)).astype(np.float32) ** power


def one_texel():
    radiance = np.zeros((64, 128, 3), np.float32)
    radiance[40, 17] = 1e6, 2e6, 3e6
    return radiance


def irradiance_at(tables, normals):
    """(N,3) as shaders interpolate it."""
    at = (0.5 * octahedron_from_directions(normals) + 0.5) * IRRADIANCE_CELLS
    corner = np.minimum(at.astype(int), IRRADIANCE_CELLS - 1)
    (u, v), (column, row) = (at - corner).T[..., None], corner.T
    table = tables.peak * tables.irradiance.reshape(IRRADIANCE_CELLS + 1, IRRADIANCE_CELLS + 1, 3)
    below = (1.0 - u) * table[row, column] + u * table[row, column + 1]
    return (1.0 - v) * below + v * ((1.0 - u) * table[row + 1, column] + u * table[row + 1, column + 1])


@pytest.mark.parametrize(
    ("radiance", "bound"), [(random_map(), 1.5e-3), (random_map(256, 512, 1), 5e-4), (one_texel(), 0.02)]
)
def test_the_irradiance_is_that_of_all_texels(radiance, bound):
    normals = np.random.default_rng(1).normal(size=(50, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    directions, solid_angles = texel_directions(*radiance.shape[:2])
    expected = np.maximum(normals @ directions.T, 0.0) @ (radiance.reshape(-1, 3) * solid_angles)
    error = irradiance_at(MapTables.of(radiance, LUMINANCE), normals) - expected
    assert np.abs(error).max() <= bound * expected.max()


def test_light_from_everywhere_has_the_irradiance_pi():
    tables = MapTables.of(np.full((256, 512, 3), 0.5, np.float32), LUMINANCE)
    assert tables.peak == pytest.approx(0.5, rel=3e-4)
    assert tables.irradiance == pytest.approx(np.full_like(tables.irradiance, np.pi), rel=1e-3)


@pytest.mark.parametrize("radiance", [random_map(), one_texel()], ids=["random", "one texel"])
def test_each_direction_with_light_above_the_horizon_has_a_density(radiance):
    tables, side = MapTables.of(radiance, LUMINANCE), 1 << COARSE_LEVELS
    leaves = tables.fine[-(1 << 2 * (ALL_LEVELS - 1)) :]
    assert (leaves > 0.0).all()
    rng = np.random.default_rng(2)
    normals, directions = rng.normal(size=(2, 20000, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    at = [np.minimum((0.5 * octahedron_from_directions(each) + 0.5), 1.0 - 1e-9) for each in (normals, directions)]
    column, row = (at[0] * MAP_NORMALS).astype(int).T
    nodes = tables.product.reshape(MAP_NORMALS**2, -1, 4)[row * MAP_NORMALS + column, -(side * side // 4) :]
    x, y = (at[1] * side).astype(int).T
    sums = nodes[np.arange(len(x)), (y // 2) * (side // 2) + x // 2, x % 2 + 2 * (y % 2)]
    lit = interpolated(radiance @ LUMINANCE.astype(np.float32), coordinates(directions)) > 0.0
    assert (sums[lit & (np.einsum("nk,nk->n", normals, directions) > 0.0)] > 0.0).all()


def test_a_node_is_the_sum_of_its_children():
    tables = MapTables.of(random_map(), LUMINANCE)
    product = tables.product.reshape(MAP_NORMALS**2, -1, 4)
    root, children = product[:, 0], product[:, 1:5].sum(2)
    assert np.allclose(root, children, rtol=1e-4)


@pytest.mark.parametrize("shape", [(1, 1), (1, 64), (64, 1), (3, 5), (512, 4096)])
@pytest.mark.parametrize("value", [0.0, 1.0, 1e9])
def test_maps_of_any_size_have_finite_tables(shape, value):
    radiance = np.full((*shape, 3), value, np.float32)
    tables = MapTables.of(radiance, LUMINANCE)
    assert all(np.isfinite(each).all() for each in (tables.irradiance, tables.product, tables.fine))
    texels = with_mip_levels(radiance, tables.peak)
    assert np.isfinite(texels.astype(np.float32)).all() and texels.shape[1] == shape[1]


def test_coordinates_are_those_of_texels():
    directions, solid_angles = texel_directions(16, 32)
    at = coordinates(directions.astype(np.float64)).reshape(16, 32, 2)
    assert at[..., 0] == pytest.approx(np.broadcast_to((np.arange(32) + 0.5) / 32, (16, 32)), abs=1e-6)
    assert at[..., 1] == pytest.approx(np.broadcast_to((np.arange(16)[:, None] + 0.5) / 16, (16, 32)), abs=1e-6)
    assert solid_angles.sum() == pytest.approx(4.0 * np.pi, rel=2e-3)
    assert np.allclose(directions_from_octahedron(octahedron_from_directions(directions)), directions, atol=1e-5)


def test_a_smaller_map_has_the_same_light():
    radiance = random_map(128, 256)
    small = reduced(radiance, 64)
    assert small.shape == (32, 64, 3)
    sums = [(each.reshape(-1, 3) * texel_directions(*each.shape[:2])[1]).sum(0) for each in (radiance, small)]
    assert sums[0] == pytest.approx(sums[1], rel=1e-3)


def test_directions_without_a_normal_are_where_the_light_is():
    """As many as the light of each half, quarter and so on; one for each part of the squares."""
    leaves = np.random.default_rng(3).random((16, 16)) ** 4
    squares = lattice(1 << 14, np.zeros(2))
    points = 0.5 * octahedron_from_directions(directions_by_light(leaves, squares)) + 0.5
    for side in (2, 4, 8):
        cells = (points * side).astype(int)
        share = np.bincount(cells[:, 1] * side + cells[:, 0], minlength=side * side) / len(points)
        light = halved(leaves[None], (16 // side).bit_length() - 1).ravel() / leaves.sum()
        assert np.abs(share - light).max() < 2e-3


@pytest.mark.parametrize("leaves", [np.eye(8), np.ones((1, 1)), 1e-30 * np.ones((4, 4))])
def test_directions_are_unit_vectors_for_any_light(leaves):
    squares = np.array([[0.0, 0.0], [0.5, 0.5], [np.nextafter(1.0, 0.0)] * 2])
    assert np.linalg.norm(directions_by_light(leaves, squares), axis=1) == pytest.approx(1.0)
