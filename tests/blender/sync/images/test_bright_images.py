# SPDX-License-Identifier: GPL-3.0-or-later
"""Texels of images of floats beyond what 16-bit floats can be, and ones that are no numbers."""

import bpy
import numpy as np
import pytest

from ism_addon.blender.sync.materials import images


def image_of(texels):
    """An image of floats with texels (H,W,3)."""
    height, width = texels.shape[:2]
    image = bpy.data.images.new("floats", width, height, float_buffer=True)
    image.pixels.foreach_set(np.concatenate([texels, np.ones((height, width, 1))], 2).astype(np.float32).ravel())
    return image


@pytest.mark.parametrize("peak", [1.0, 65504.0, 65505.0, 3e5, 1e9])
def test_bright_texels_are_kept(peak):
    """All are within 2^-11 of themselves, or of a 10^-9th of the brightest one."""
    texels = np.geomspace(1e-4 * peak, peak, 24).reshape(2, 4, 3)
    image = images.read(image_of(texels))
    assert (image.scale == 1.0) == (peak <= 65504.0)
    assert images.linear(image) == pytest.approx(texels, rel=2.0**-11, abs=1e-9 * peak)
    assert images.mean_texel(image) == pytest.approx([*texels.mean((0, 1)), 1.0], rel=1e-3)


@pytest.mark.parametrize(
    ("value", "expected"),
    [(np.nan, 0.0), (np.inf, 0.0), (-np.inf, 0.0), (1e30, images.MAX_TEXEL), (-3.0, -3.0), (-1e6, -1e6)],
)
def test_texels_that_are_not_finite_are_black(value, expected):
    texels = np.full((2, 4, 3), 1000.0)
    texels[1, 2] = value
    expected_texels = np.where(texels == 1000.0, 1000.0, expected)
    assert images.linear(images.read(image_of(texels))) == pytest.approx(expected_texels, rel=1e-2)
