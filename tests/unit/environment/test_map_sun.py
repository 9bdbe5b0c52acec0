# SPDX-License-Identifier: GPL-3.0-or-later
"""The sun that is taken out of a map of all directions."""

import numpy as np
import pytest

from ism_addon.color import REC709, luminance
from ism_addon.gpu.environment.equirectangular import texel_directions
from ism_addon.gpu.environment.map_sun import without_sun

LUMINANCE = luminance(REC709)
HEIGHT, WIDTH = 256, 512


def sky(height=HEIGHT, width=WIDTH):
    return np.random.default_rng(0).random((height, width, 3)).astype(np.float32)


def with_sun(row, column, radius=2.5, radiance=(9e4, 1e5, 8e4), texels=None):
    """A sky with a disc in it, of a radius in texels of its row."""
    texels = sky() if texels is None else texels
    height, width = texels.shape[:2]
    rows, columns = np.mgrid[:height, :width]
    across = (columns - column + width // 2) % width - width // 2
    inside = np.hypot(across * np.sin(np.pi * (row + 0.5) / height), rows - row) < radius
    texels[inside] += np.float32(radiance)
    return texels


def irradiance(radiance, normal):
    """(3,) of a map's texels, all of which count whether they are above the horizon or not."""
    directions, solid_angles = texel_directions(*radiance.shape[:2])
    return (directions @ normal) @ (radiance.reshape(-1, 3).astype(float) * solid_angles)


def patched(rest, sun):
    """A map of what was left, and the sun added again."""
    radiance = rest.astype(float)
    (row, column), (rows, columns) = sun.first_texel, sun.radiance.shape
    at = np.arange(row, row + rows)[:, None], np.arange(column, column + columns) % rest.shape[1]
    radiance[at] += sun.radiance[..., None].astype(float) * sun.irradiance
    return radiance


@pytest.mark.parametrize(("row", "column"), [(180, 100), (180, 511), (128, 0), (20, 300), (250, 17)])
def test_the_sun_and_the_rest_are_the_map(row, column):
    radiance = with_sun(row, column)
    rest, sun = without_sun(radiance, LUMINANCE)
    assert sun is not None
    assert np.allclose(patched(rest, sun), radiance, rtol=1e-5, atol=0.02)
    assert rest.max() < 0.01 * radiance.max() and rest.min() >= 0.0
    at_rest = irradiance(radiance, sun.direction) - irradiance(rest, sun.direction)
    assert sun.irradiance == pytest.approx(at_rest, rel=1e-4)
    for normal in np.eye(3):
        expected = sun.irradiance * (sun.direction @ normal)
        assert irradiance(radiance - rest, normal) == pytest.approx(expected, abs=1e-4 * sun.irradiance.max())
    assert sun.probability.sum() == pytest.approx(1.0, rel=1e-5)


def test_an_even_disc_is_as_wide():
    texel = np.pi / 1024
    _, sun = without_sun(with_sun(600, 700, 8.0, texels=np.zeros((1024, 2048, 3), np.float32)), LUMINANCE)
    assert sun.angular_diameter == pytest.approx(2.0 * 8.0 * texel, rel=0.03)


def test_what_has_another_color_than_the_sun_stays():
    radiance = with_sun(180, 100, 2.5, (1e5, 1e5, 1e5))
    radiance[180, 101] = 2e5, 1e5, 1e5
    rest, sun = without_sun(radiance, LUMINANCE)
    assert np.allclose(patched(rest, sun), radiance, rtol=1e-5, atol=0.02)
    assert rest[180, 101, 0] > 1e4 > rest[180, 101, 1:].max()


@pytest.mark.parametrize(
    "radiance",
    [
        sky(),
        np.zeros((8, 16, 3), np.float32),
        np.ones((1, 1, 3), np.float32),
        with_sun(180, 100, radiance=(0.0, 0.0, 0.0)),
        with_sun(180, 100, 1.5, radiance=(60.0, 60.0, 60.0)),  # bright, but too small to light anything
        with_sun(HEIGHT - 1, 0),
        with_sun(0, 9),
        np.full((4, 8, 3), 1e30, np.float32),
    ],
    ids=["noise", "black", "one texel", "no sun", "a lamp", "at the zenith", "at the nadir", "bright"],
)
def test_maps_without_a_sun_stay_as_they_are(radiance):
    rest, sun = without_sun(radiance, LUMINANCE)
    assert sun is None and np.array_equal(rest, radiance)
