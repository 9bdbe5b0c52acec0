# SPDX-License-Identifier: GPL-3.0-or-later
"""Mip levels that are made in bands equal those of the whole image, and take a fraction of its memory."""

import tracemalloc

import numpy as np
import pytest

from ism_addon.gpu.buffers.mip_levels import mip_levels
from ism_addon.scene import Encoding, Image
from tests.unit.buffers.mip_chain import mip_chain


def noise(height: int, width: int, encoding: Encoding = Encoding.SRGB) -> Image:
    bytes_ = np.random.default_rng(3).integers(0, 256, (height, width, 4), np.uint8)
    return Image((bytes_ / 85.0).astype(np.float16) if encoding is Encoding.FLOAT else bytes_, True, encoding)


@pytest.mark.parametrize("size", [(1, 1), (1, 300), (300, 1), (2, 3), (63, 64), (64, 63), (191, 5), (257, 130)])
@pytest.mark.parametrize("encoding", Encoding)
def test_bands_make_the_levels_of_the_whole_image(encoding, size):
    image = noise(*size, encoding)
    expected = [level.reshape(-1, 4) for level in mip_chain(image)]
    found: list[list[np.ndarray]] = [[] for _ in expected]
    for level, first, texels in mip_levels(image):
        assert first == sum(map(len, found[level]))  # the parts follow one another
        found[level].append(texels)
    for parts, whole in zip(found, expected, strict=True):
        assert np.array_equal(np.concatenate(parts), whole)


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
