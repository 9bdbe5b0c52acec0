# SPDX-License-Identifier: GPL-3.0-or-later
"""Mip levels that are made in bands equal those of the whole image, and take a fraction of its memory."""

import tracemalloc

import numpy as np
import pytest

from ism_addon.color import linear_from_srgb
from ism_addon.gpu.buffers.mip_levels import mip_levels
from ism_addon.scene import Encoding, Image
from tests.unit.buffers.mip_chain import mip_chain


def noise(height: int, width: int, encoding: Encoding = Encoding.SRGB, straight_alpha: bool = False) -> Image:
    bytes_ = np.random.default_rng(3).integers(0, 256, (height, width, 4), np.uint8)
    return Image(
        (bytes_ / 85.0).astype(np.float16) if encoding is Encoding.FLOAT else bytes_, True, encoding, straight_alpha
    )


@pytest.mark.parametrize("size", [(1, 1), (1, 300), (300, 1), (2, 3), (63, 64), (64, 63), (191, 5), (257, 130)])
@pytest.mark.parametrize("encoding", Encoding)
@pytest.mark.parametrize("straight_alpha", [False, True])
def test_bands_make_the_levels_of_the_whole_image(encoding, size, straight_alpha):
    image = noise(*size, encoding, straight_alpha)
    expected = [level.reshape(-1, 4) for level in mip_chain(image)]
    found: list[list[np.ndarray]] = [[] for _ in expected]
    for level, first, texels in mip_levels(image):
        assert first == sum(map(len, found[level]))  # the parts follow one another
        found[level].append(texels)
    for parts, whole in zip(found, expected, strict=True):
        assert np.array_equal(np.concatenate(parts), whole)


@pytest.mark.parametrize("contrast", [0.2, 1.0])
def test_the_first_halved_level_is_as_bright_as_what_is_interpolated(contrast):
    texels = np.full((64, 64, 4), 255, np.uint8)
    texels[..., :3] = 128.0 + contrast * (np.random.default_rng(5).integers(0, 256, (64, 64, 3)) - 128.0)
    at = (np.arange(63 * 8) + 0.5) / 8.0  # between the middles of texels
    low, f = at.astype(int), at % 1.0
    rows = texels[low, :, :3] * (1.0 - f[:, None, None]) + texels[low + 1, :, :3] * f[:, None, None]
    interpolated = rows[:, low] * (1.0 - f[:, None]) + rows[:, low + 1] * f[:, None]
    expected = linear_from_srgb(interpolated / 255.0).mean()
    level = np.concatenate([part for level, _, part in mip_levels(Image(texels, True, Encoding.SRGB)) if level == 1])
    assert abs(linear_from_srgb(level[:, :3] / 255.0).mean() / expected - 1.0) < 0.01
    assert linear_from_srgb(texels[..., :3] / 255.0).mean() > 1.01 * expected


@pytest.mark.parametrize("encoding", [Encoding.SRGB, Encoding.LINEAR])
def test_colors_of_straight_alpha_are_weighted_by_it(encoding):
    """A decal: where it is opaque it has the same colour at all levels, whatever is stored around it."""
    texels = np.zeros((64, 64, 4), np.uint8)
    texels[13:47, 9:31] = 200, 100, 50, 255
    levels = [part for level, _, part in mip_levels(Image(texels, True, encoding, True)) if level]
    covered = np.concatenate(levels)
    covered = covered[covered[:, 3] > 8]
    assert len(covered) > 30
    assert np.abs(covered[:, :3].astype(int) - (200, 100, 50)).max() <= 2
    transparent = np.full((8, 8, 4), 77, np.uint8)
    transparent[..., 3] = 0
    for _, _, part in mip_levels(Image(transparent, True, encoding, True)):
        assert np.abs(part.astype(int) - (77, 77, 77, 0)).max() <= 1


def test_bands_take_a_fraction_of_the_memory_of_the_image():
    image = noise(2048, 1024)
    tracemalloc.start()
    try:
        for _part in mip_levels(image):
            pass
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < image.texels.nbytes  # whole levels of floats would take six times as much
