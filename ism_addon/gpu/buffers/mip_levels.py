# SPDX-License-Identifier: GPL-3.0-or-later
"""The mip levels of an image, made in bands of few rows: all of them as floats would take seven times its memory.

Several bands are made at once, on all processor cores.
"""

from collections.abc import Iterator
from functools import cache

import numpy as np

from ...color import linear_from_srgb, srgb_from_linear
from ...half_floats import floats, halves
from ...parallel import parallel_results
from ...scene import Encoding, Image

#: Levels that are made of each band. The rest are made of all bands' last rows together.
BAND_LEVELS = 6

#: Weight of a transparent texel's colour relative to an opaque one's.
MIN_WEIGHT = np.float32(1.0 / 4096.0)


def mip_levels(image: Image) -> Iterator[tuple[int, int, np.ndarray]]:
    """Bands of an image and of its halved copies down to one texel.

    Yields the level, its first texel in this band, and the texels (N,4) in the image's encoding. Averages are taken in
    linear light, of what interpolation gives between texels, and weighted by straight alpha. If a side is odd, its last
    texel is an average of three.
    """
    height, width = image.texels.shape[:2]
    levels = min(BAND_LEVELS, height.bit_length() - 1)
    tops = [band << levels for band in range(height >> levels)]
    bands = list(zip(tops, [*tops[1:], height], strict=True))

    def levels_of(band: tuple[int, int]) -> tuple[list[tuple[int, int, np.ndarray]], np.ndarray]:
        """What is yielded of a band, from a first row to before another, and its last level."""
        top, texels = band[0], image.texels[slice(*band)]
        found, linear = [(0, top * width, texels.reshape(-1, 4))], decoded(texels, image)
        for level in range(1, levels + 1):
            linear = halved(linear)
            if level == 1 and image.encoding is Encoding.SRGB:
                darken(linear, texels, image.straight_alpha)
            found.append((level, (top >> level) * linear.shape[1], encoded(linear, image).reshape(-1, 4)))
        return found, linear

    ends = []
    for found, end in parallel_results(levels_of, bands, height * width):
        yield from found
        ends.append(end)
    linear, level = np.concatenate(ends), levels
    while linear.shape[0] > 1 or linear.shape[1] > 1:
        linear, level = halved(linear), level + 1
        yield level, 0, encoded(linear, image).reshape(-1, 4)


def darken(linear: np.ndarray, texels: np.ndarray, straight_alpha: bool = False) -> None:
    """Make averages (H//2,W//2,4) of sRGB texels (H,W,4) those of what bilinear interpolation gives between the texels.

    As in Cycles, sRGB values are interpolated before they are decoded. The mean of the square of an interpolation is
    that of the texels' squares less a sixth of squared differences along each axis, plus a 36th of mixed ones.
    """
    height, width = (size // 2 * 2 for size in texels.shape[:2])
    if not height or not width:
        return
    corners = [texels[y:height:2, x:width:2] for y in (0, 1) for x in (0, 1)]
    a, b, c, d = (each[..., :3].astype(np.int16) for each in corners)
    top, bottom, left, right = b - a, d - c, c - a, d - b
    if straight_alpha:  # colours that are interpolated with transparent ones stay the same
        for difference, ends in zip((top, bottom, left, right), ((0, 1), (2, 3), (0, 2), (1, 3)), strict=True):
            alpha = np.minimum(*(corners[k][..., 3:] for k in ends))
            np.multiply(difference, alpha / np.float32(255.0), out=difference, casting="unsafe")
    loss = np.zeros(top.shape, np.float32)
    for difference in (top, bottom, left, right):
        loss += np.square(difference, dtype=np.float32)
    loss *= 3.0
    loss -= np.square(bottom - top, dtype=np.float32)
    loss *= curvature()[a + b + c + d >> 2]
    averages = linear[: len(loss), : loss.shape[1]]
    averages[..., :3] -= loss * weights(averages) if straight_alpha else loss


@cache
def curvature() -> np.ndarray:
    """(256,) float32: for each byte a 72nd of the second derivative of linear values."""
    values = np.arange(256) / 255.0
    second = np.where(values > 0.04045, 2.4 * 1.4 / 1.055**2 * ((values + 0.055) / 1.055) ** 0.4, 0.0)
    return (second / 72.0 / 255.0**2).astype(np.float32)


def weights(values: np.ndarray) -> np.ndarray:
    """(…,1): what colours (…,4) of straight alpha are multiplied by. Transparent ones count where there is no other."""
    return values[..., 3:] + MIN_WEIGHT


def decoded(texels: np.ndarray, image: Image) -> np.ndarray:
    """(H,W,4) float32: linear values and alpha of texels, colours weighted by straight alpha."""
    if image.encoding is Encoding.FLOAT:
        return floats(texels)
    linear = linear_values(image.encoding)[texels]
    linear[..., 3] = texels[..., 3] / np.float32(255.0)
    if image.straight_alpha:
        linear[..., :3] *= weights(linear)
    return linear


def encoded(linear: np.ndarray, image: Image) -> np.ndarray:
    """Texels of such values (H,W,4). sRGB is encoded by a look-up table with 16-bit indices."""
    if image.encoding is Encoding.FLOAT:
        return halves(linear)
    color = linear[..., :3]
    if image.straight_alpha:
        color = np.minimum(color / weights(linear), np.float32(1.0))
    texels = np.rint(linear * 255.0).astype(np.uint8)
    if image.encoding is Encoding.SRGB:
        texels[..., :3] = srgb_bytes()[(color * np.float32(65535.0) + np.float32(0.5)).astype(np.uint16)]
    else:
        texels[..., :3] = np.rint(color * 255.0)
    return texels


@cache
def linear_values(encoding: Encoding) -> np.ndarray:
    """(256,) float32: the linear value of each byte."""
    values = np.arange(256) / 255.0
    return (linear_from_srgb(values) if encoding is Encoding.SRGB else values).astype(np.float32)


@cache
def srgb_bytes() -> np.ndarray:
    """(65536,) uint8: the sRGB byte of each linear value k/65535."""
    return np.rint(srgb_from_linear(np.arange(65536) / 65535.0) * 255.0).astype(np.uint8)


def halved(image: np.ndarray) -> np.ndarray:
    """Averages of pairs of rows of an image (H,W,4), then of columns, as far as there are two.

    Of the last three, if the number is odd.
    """
    texels = 1
    for axis in (0, 1):
        if image.shape[axis] > 1:
            image, texels = sums_of_pairs(image, axis), 2 * texels
    image *= np.float32(1.0 / texels)
    return image


def sums_of_pairs(image: np.ndarray, axis: int) -> np.ndarray:
    """Sums of pairs along an axis; of the last three if the number is odd, two thirds."""
    result = np.empty([size // 2 if each == axis else size for each, size in enumerate(image.shape)], np.float32)
    image, sums = np.moveaxis(image, axis, 0), np.moveaxis(result, axis, 0)
    pairs = len(image) // 2 * 2
    first, second = image[0:pairs:2], image[1:pairs:2]
    if axis == 0:
        np.add(first, second, out=sums)
    else:  # two channels as a complex number, of all columns at once: numpy adds four channels column by column
        a, b, complex_sums = (each.view(np.complex64) for each in (first, second, sums))
        for two in (0, 1):
            np.add(a[..., two], b[..., two], out=complex_sums[..., two])
    if len(image) > pairs:
        sums[-1] = (image[-3] + image[-2] + image[-1]) / np.float32(1.5)
    return result
