# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures that are computed: their means, and that what needs no distortion has none."""

import numpy as np
import pytest

from ism_addon.shading.builder import Builder, constant
from ism_addon.shading.operations import OPERATIONS
from ism_addon.shading.textures import METRICS, NOISE_MEANS, voronoi_options
from tests.unit.shading import glsl_functions

COUNT = 4000
#: Largest difference of a texture's mean from the one that is estimated.
TOLERANCE = 0.15


def mean_of(device, name, dimensions, options, *constants):
    """Means of a texture's components at random points, whose numbers beyond its dimensions are 0."""
    points = np.random.default_rng(1).uniform(-50.0, 50.0, (COUNT, 4)) * (np.arange(4) < dimensions)
    arguments = ", ".join(["a0", *map(str, constants), *map(str, options)])
    file = OPERATIONS[name].file
    call = f"{name}({arguments})"
    if OPERATIONS[name].result == "Voronoi":
        call = f"vec4(voronoi_color({call}), voronoi_distance({call}))"
    values = glsl_functions.evaluate(device, f"nodes/{file}.glsl", call, [points])
    assert np.isfinite(values).all()
    return values.mean(0)


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
@pytest.mark.parametrize("type_", NOISE_MEANS)
def test_the_mean_of_noise(device, type_, dimensions):
    # Detail, roughness, lacunarity, offset and gain that Blender's node has.
    name, inputs = f"noise_{type_}_color", (2.0, 0.5, 2.0, 0.0, 1.0)
    mean = mean_of(device, name, dimensions, [dimensions], *inputs)[:3]
    assert mean == pytest.approx(NOISE_MEANS[type_], abs=TOLERANCE)


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
def test_the_mean_of_white_noise(device, dimensions):
    mean = mean_of(device, "white_noise_color", dimensions, [dimensions])[:3]
    assert mean == pytest.approx(OPERATIONS["white_noise_color"].mean, abs=0.05)


@pytest.mark.parametrize("has_integer_hash", [False, True])
@pytest.mark.parametrize("name", ["voronoi_f1", "voronoi_f2", "voronoi_smooth_f1"])
@pytest.mark.parametrize(("dimensions", "metric"), list(enumerate(METRICS, 1)))
def test_the_mean_of_normalized_voronoi_textures(device, name, dimensions, metric, has_integer_hash):
    options = voronoi_options(dimensions, metric, True, has_integer_hash)
    inputs = [1.5, 0.5, 2.0, 0.8, 1.0] + [1.0] * (name == "voronoi_smooth_f1")
    *color, distance = mean_of(device, name, dimensions, [options], *inputs)
    assert color == pytest.approx([0.5] * 3, abs=TOLERANCE)
    assert 0.05 < distance < 0.6


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
def test_edges_and_radii_are_within_half_of_a_cells_diagonal(device, dimensions):
    options = voronoi_options(dimensions, METRICS[0], False, True)
    half = 0.5 * np.sqrt(dimensions)
    assert 0.1 * half < mean_of(device, "voronoi_n_sphere_radius", dimensions, [options], 1.0)[0] < half
    assert 0.02 < mean_of(device, "voronoi_distance_to_edge", dimensions, [options], 0.0, 0.5, 2.0, 1.0)[0] < half


@pytest.mark.parametrize(("name", "orientation"), [("gabor_2d", 0.5), ("gabor_3d", "vec3(0.0, 0.0, 1.0)")])
def test_the_mean_of_gabor_textures(device, name, orientation):
    value, phase, intensity, _ = mean_of(device, name, int(name[-2]), [], 2.0, 0.5, orientation)
    assert (value, phase) == pytest.approx((0.5, 0.5), abs=TOLERANCE)
    assert 0.0 < intensity < 0.5


def test_distortion_of_zero_is_left_out():
    for simplify in (True, False):
        builder = Builder(simplify)
        point = builder.call("texture_point", constant((1.0, 2.0, 3.0)), constant(0.0), constant(1.0), parameter=3)
        is_same = builder.call("noise_distorted", point, constant(0.0), parameter=3) == point
        assert is_same == simplify
