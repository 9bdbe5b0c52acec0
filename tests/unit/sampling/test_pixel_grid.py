# SPDX-License-Identifier: GPL-3.0-or-later
"""Pixel grids: the distribution of subpixel offsets, and the mapping of samples to texels."""

import numpy as np
import pytest

from ism_addon.sampling.pixel_grid import PIXEL_GRIDS, narrow_pixel_grid, pixel_grid


def offsets_of(samples: int, count: int) -> np.ndarray:
    """(samples,2) px from the pixel's centre."""
    return np.concatenate([pixel_grid(index, count).subpixel_offsets for index in range(samples // count)])


@pytest.mark.parametrize("count", PIXEL_GRIDS)
def test_offsets_are_uniform_in_the_pixel(count):
    offsets = offsets_of(8192, count)
    assert np.abs(offsets).max() <= 0.5
    assert np.abs(offsets.mean(0)).max() < 2e-3
    assert offsets.var(0) == pytest.approx(1.0 / 12.0, rel=0.01)
    assert abs(np.corrcoef(offsets.T)[0, 1]) < 0.01


@pytest.mark.parametrize("count", PIXEL_GRIDS)
def test_the_first_sample_is_at_the_centre(count):
    assert not pixel_grid(0, count).offset.any()
    assert not pixel_grid(0, count).subpixel_offsets[0].any()


@pytest.mark.parametrize("count", PIXEL_GRIDS)
def test_the_samples_of_a_grid_are_its_texels(count):
    """Each texel belongs to one sample of one pixel."""
    grids = [pixel_grid(index, count) for index in (0, 1, 5, 77)]
    for one in grids:
        assert np.linalg.det(one.fine_from_pixel) == pytest.approx(count)
        assert one.texels == pytest.approx((one.subpixel_offsets - one.offset) @ one.fine_from_pixel.T, abs=1e-9)
        pixels = np.stack(np.meshgrid(np.arange(9), np.arange(7)), -1).reshape(-1, 1, 2)
        first, size = one.bounds(9, 7)
        texels = (pixels @ one.fine_from_pixel.T + first + one.texels).reshape(-1, 2)
        assert len({tuple(texel) for texel in texels}) == 9 * 7 * count
        assert (texels.min(0) == 0).all() and (texels.max(0) == size - 1).all()
    assert len({tuple(one.offset) for one in grids}) == len(grids)


@pytest.mark.parametrize("count", PIXEL_GRIDS)
def test_grids_of_equally_many_samples_have_one_maximum_size(count):
    """They nearly reach it. So an image allocates memory for its texels once."""
    grids = [pixel_grid(index, count) for index in range(500)]
    sizes = np.array([one.bounds(9, 7)[1] for one in grids])
    limits = np.array([one.max_size(9, 7) for one in grids])
    assert (limits == limits[0]).all()
    assert (sizes.max(0) <= limits[0]).all()
    assert (sizes.max(0) >= limits[0] - 3).all()


@pytest.mark.parametrize("count", PIXEL_GRIDS)
def test_clip_coordinates_of_the_grid(count):
    """They map a sample's position to the centre of its texel."""
    one, size = pixel_grid(3, count), np.array([9, 7])
    matrix, shift = one.fine_from_clip(*size)
    first, grid_size = one.bounds(*size)
    for pixel in ([0, 0], [8, 6], [3, 5]):
        for offset, texel in zip(one.subpixel_offsets, one.texels, strict=True):
            clip = 2.0 * (np.array(pixel) + 0.5 + offset) / size - 1.0
            position = (0.5 * (matrix @ clip + shift) + 0.5) * grid_size
            assert position == pytest.approx(one.fine_from_pixel @ pixel + first + texel + 0.5, abs=1e-9)


def test_all_x_and_all_y_of_a_grid_differ():
    for column in pixel_grid(0, 16).subpixel_offsets.T:
        assert len(set(np.round(column, 6))) == 16


def test_the_first_few_offsets_are_stratified():
    """In x and in y the first four lie in different quarters, and the first eight in different eighths."""
    for few in (4, 8):
        for column in pixel_grid(0, 16).subpixel_offsets[:few].T:
            assert len(set(np.floor((column + 0.5) * few + 1e-9))) == few


@pytest.mark.parametrize("width", [0.01, 0.5])
def test_a_narrow_filter_is_importance_sampled(width):
    offsets = np.concatenate([narrow_pixel_grid(index, width).subpixel_offsets for index in range(4096)])
    assert np.abs(offsets[0]).max() < 1e-12
    assert np.abs(offsets).max() <= width
    t = np.linspace(-1.0, 1.0, 4001)
    k = np.pi * (t + 1.0)
    weight = 0.35875 - 0.48829 * np.cos(k) + 0.14128 * np.cos(2 * k) - 0.01168 * np.cos(3 * k)
    assert np.abs(offsets.mean(0)).max() < 0.01 * width
    assert offsets.var(0) == pytest.approx(width**2 * (weight * t**2).sum() / weight.sum(), rel=0.02)
