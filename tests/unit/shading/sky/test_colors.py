# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours of skies: symmetry, images, and the ends of all settings. tests/blender compares them with Cycles."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.shading.sky import Sky, SkyModel, radiance, sky_image
from ism_addon.shading.sky.parameters import ANALYTIC, direction_at

SCATTERING = [model for model in SkyModel if model not in ANALYTIC]
ELEVATION, ROTATION = 0.3, 0.7


def sky_with_sun(model, elevation=ELEVATION, rotation=ROTATION, **settings):
    """A sky whose sun is there, in the settings of any model."""
    direction = direction_at(elevation, rotation)
    return Sky(model, sun_direction=direction, sun_elevation=elevation, sun_rotation=rotation, **settings)


def random_directions(count=200):
    directions = np.random.default_rng(3).normal(size=(count, 3))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)


def turned(directions, angle):
    """Directions turned from north to east."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return directions @ np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def assert_equal_colors(ours, expected, tolerance=1e-4):
    assert np.abs(ours - expected).max() <= tolerance * expected.max()


@pytest.mark.parametrize("model", SkyModel)
def test_an_image_has_the_colors_of_its_texel_centres(model):
    sky, height = sky_with_sun(model), 24
    image = sky_image(sky, 2 * height)
    assert image.shape == (height, 2 * height, 3) and image.dtype == np.float32
    elevation = ((np.arange(height) + 0.5) / height - 0.5) * math.pi
    # Blender's direction of an environment texture's u: x is in its middle, y at a quarter.
    azimuth = (0.5 - (np.arange(2 * height) + 0.5) / (2 * height)) * 2.0 * math.pi
    east, north = np.outer(np.cos(elevation), np.cos(azimuth)), np.outer(np.cos(elevation), np.sin(azimuth))
    directions = np.stack([east, north, np.broadcast_to(np.sin(elevation)[:, None], east.shape)], -1)
    assert_equal_colors(image, radiance(sky, directions.reshape(-1, 3)).reshape(image.shape))


@pytest.mark.parametrize("model", SkyModel)
def test_skies_are_brightest_below_the_sun_or_at_it(model):
    image = sky_image(sky_with_sun(model), 128).sum(2)
    row, column = np.unravel_index(image.argmax(), image.shape)
    assert 32 <= row <= 32 + 64 * ELEVATION / math.pi
    rotation = 0.5 * math.pi - (0.5 - (column + 0.5) / 128) * 2.0 * math.pi
    assert rotation == pytest.approx(ROTATION, abs=0.03)


@pytest.mark.parametrize("model", SkyModel)
def test_both_sides_of_the_sun_are_equal(model):
    sky, directions = sky_with_sun(model), random_directions()
    across = np.array(direction_at(0.0, ROTATION + 0.5 * math.pi))
    mirrored = directions - 2.0 * (directions @ across)[:, None] * across
    assert_equal_colors(radiance(sky, directions), radiance(sky, mirrored))


@pytest.mark.parametrize("model", SkyModel)
def test_the_sky_turns_with_the_sun(model):
    directions = random_directions()
    here, there = sky_with_sun(model), sky_with_sun(model, rotation=ROTATION + 2.0)
    assert_equal_colors(radiance(there, turned(directions, 2.0)), radiance(here, directions))


@pytest.mark.parametrize("model", SCATTERING)
@pytest.mark.parametrize("turns", [-2, 0, 1])
def test_a_sun_beyond_the_zenith_is_on_the_other_side(model, turns):
    directions = random_directions()
    other = sky_with_sun(model, math.pi - ELEVATION + 2.0 * math.pi * turns, ROTATION + math.pi)
    assert_equal_colors(radiance(other, directions), radiance(sky_with_sun(model), directions))


@pytest.mark.parametrize("model", SCATTERING)
def test_light_does_not_jump_where_the_sun_sets(model):
    """Below the horizon, rows are interpolated from other azimuths."""
    directions = random_directions()
    risen, set_ = (radiance(sky_with_sun(model, elevation), directions) for elevation in (0.0, -1e-6))
    assert_equal_colors(set_, risen, 2e-3)


def test_turbidities_between_those_of_the_dataset_are_interpolated():
    directions, sky = random_directions(), sky_with_sun(SkyModel.HOSEK_WILKIE)
    colors = [radiance(replace(sky, turbidity=turbidity), directions) for turbidity in (3.999, 4.0, 4.001)]
    assert_equal_colors(colors[0], colors[1], 2e-3)
    assert_equal_colors(colors[2], colors[1], 2e-3)


@pytest.mark.parametrize("model", [SkyModel.NISHITA, SkyModel.SINGLE_SCATTERING])
def test_the_ground_of_single_scattering_is_black(model):
    steep = direction_at(-0.5, 0.0), direction_at(-0.4, ROTATION), direction_at(-0.5 * math.pi, 0.0)
    black, dim, nadir = radiance(sky_with_sun(model), np.array(steep))
    assert not black.any() and not nadir.any() and dim.any()


@pytest.mark.parametrize("model", sorted(ANALYTIC))
@pytest.mark.parametrize("turbidity", [1.0, 10.0])
@pytest.mark.parametrize("direction", [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.0)])
def test_analytic_skies_are_finite_at_the_ends_of_settings(model, turbidity, direction):
    directions = np.concatenate([random_directions(), np.eye(3), -np.eye(3)])
    for albedo in (0.0, 1.0):
        sky = Sky(model, sun_direction=direction, turbidity=turbidity, ground_albedo=albedo)
        colors = radiance(sky, directions)
        assert np.isfinite(colors).all() and colors.min() >= 0.0


@pytest.mark.parametrize("model", SCATTERING)
@pytest.mark.parametrize(
    ("elevation", "altitude", "air", "aerosols", "ozone"),
    [
        (0.5 * math.pi, 0.0, 0.0, 0.0, 0.0),
        (-0.5 * math.pi, 0.0, 10.0, 10.0, 10.0),
        (-0.1, 100e3, 1.0, 10.0, 0.0),
        (0.0, 60e3, 10.0, 0.0, 10.0),
        (0.1, 0.0, 1000.0, 1000.0, 1000.0),
    ],
)
def test_scattering_is_finite_at_the_ends_of_settings(model, elevation, altitude, air, aerosols, ozone):
    sky = sky_with_sun(
        model, elevation, altitude=altitude, air_density=air, aerosol_density=aerosols, ozone_density=ozone
    )
    colors = radiance(sky, np.concatenate([random_directions(), np.eye(3), -np.eye(3)]))
    assert np.isfinite(colors).all() and colors.min() >= 0.0
