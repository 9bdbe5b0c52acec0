# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples lie in their pixels where they should."""

import numpy as np
import pytest

from ism_addon.sampling.pixel_grid import PIXEL_GRIDS, narrow_pixel_grid, pixel_grid


def places(samples: int, count: int) -> np.ndarray:
    """(samples,2) px off the pixel's centre."""
    return np.concatenate([pixel_grid(number, count).subpixel_offsets for number in range(samples // count)])


@pytest.mark.parametrize("count", PIXEL_GRIDS)
def test_places_fill_the_pixel_evenly(count):
    offsets = places(8192, count)
    assert np.abs(offsets).max() <= 0.5
    assert np.abs(offsets.mean(0)).max() < 2e-3
    assert offsets.var(0) == pytest.approx(1.0 / 12.0, rel=0.01)
    assert abs(np.corrcoef(offsets.T)[0, 1]) < 0.01


@pytest.mark.parametrize("count", PIXEL_GRIDS)
def test_the_first_place_is_the_centre(count):
    assert not pixel_grid(0, count).offset.any()
    assert not pixel_grid(0, count).subpixel_offsets[0].any()


@pytest.mark.parametrize("count", PIXEL_GRIDS)
def test_the_places_of_a_grid_are_the_fine_pixels_of_a_pixel(count):
    """Of each pixel others, and of all pixels together all that lie in the picture."""
    grids = [pixel_grid(number, count) for number in (0, 1, 5, 77)]
    for one in grids:
        assert np.linalg.det(one.fine_from_pixel) == pytest.approx(count)
        assert one.texels == pytest.approx((one.subpixel_offsets - one.off) @ one.fine_from_pixel.T, abs=1e-9)
        pixels = np.stack(np.meshgrid(np.arange(9), np.arange(7)), -1).reshape(-1, 1, 2)
        first, size = one.bounds(9, 7)
        fine = (pixels @ one.fine_from_pixel.T + first + one.texels).reshape(-1, 2)
        assert len({tuple(texel) for texel in fine}) == 9 * 7 * count
        assert (fine.min(0) == 0).all() and (fine.max(0) == size - 1).all()
    assert len({tuple(one.off) for one in grids}) == len(grids)


@pytest.mark.parametrize("count", PIXEL_GRIDS)
def test_all_grids_of_as_many_places_fit_into_the_room_of_each(count):
    """And nearly fill it: a picture needs memory for its fine pixels once."""
    grids = [pixel_grid(number, count) for number in range(500)]
    sizes = np.array([one.bounds(9, 7)[1] for one in grids])
    rooms = np.array([one.max_size(9, 7) for one in grids])
    assert (rooms == rooms[0]).all()
    assert (sizes.max(0) <= rooms[0]).all()
    assert (sizes.max(0) >= rooms[0] - 3).all()


@pytest.mark.parametrize("count", PIXEL_GRIDS)
def test_a_fine_pixel_shows_what_is_at_its_place(count):
    """In clip coordinates: from a place in the picture to the centre of its pixel in the fine one."""
    one, size = pixel_grid(3, count), np.array([9, 7])
    turn, shift = one.fine_from_clip(*size)
    first, fine_size = one.bounds(*size)
    for pixel in ([0, 0], [8, 6], [3, 5]):
        for place, texel in zip(one.subpixel_offsets, one.texels, strict=True):
            clip = 2.0 * (np.array(pixel) + 0.5 + place) / size - 1.0
            fine = (0.5 * (turn @ clip + shift) + 0.5) * fine_size
            assert fine == pytest.approx(one.fine_from_pixel @ pixel + first + texel + 0.5, abs=1e-9)


def test_a_turned_grid_has_a_place_on_each_line_along_the_pixels_sides():
    for column in pixel_grid(0, 16).subpixel_offsets.T:
        assert len(set(np.round(column, 6))) == 16


def test_the_first_few_places_are_spread_as_all_are():
    """Of four one in each quarter along either side, of eight one in each eighth."""
    for few in (4, 8):
        for column in pixel_grid(0, 16).subpixel_offsets[:few].T:
            assert len(set(np.floor((column + 0.5) * few + 1e-9))) == few


@pytest.mark.parametrize("reach", [0.01, 0.5])
def test_a_narrow_filter_is_followed_by_the_places_themselves(reach):
    offsets = np.concatenate([narrow_pixel_grid(number, reach).subpixel_offsets for number in range(4096)])
    assert np.abs(offsets[0]).max() < 1e-12
    assert np.abs(offsets).max() <= reach
    t = np.linspace(-1.0, 1.0, 4001)
    k = np.pi * (t + 1.0)
    weight = 0.35875 - 0.48829 * np.cos(k) + 0.14128 * np.cos(2 * k) - 0.01168 * np.cos(3 * k)
    assert np.abs(offsets.mean(0)).max() < 0.01 * reach
    assert offsets.var(0) == pytest.approx(reach**2 * (weight * t**2).sum() / weight.sum(), rel=0.02)
