# SPDX-License-Identifier: GPL-3.0-or-later
"""All mip levels of an image, each computed as a whole."""

import numpy as np

from ism_addon.gpu.buffers.mip_levels import darken, decoded, encoded
from ism_addon.scene import Encoding, Image


def mip_chain(image: Image) -> list[np.ndarray]:
    """An image and its halved copies down to one texel, each as texels (H,W,4) of its encoding."""
    chain, linear = [image.texels], decoded(image.texels, image)
    while linear.shape[0] > 1 or linear.shape[1] > 1:
        for axis in (0, 1):
            if linear.shape[axis] > 1:
                linear = halved(linear, axis)
        if len(chain) == 1 and image.encoding is Encoding.SRGB:
            darken(linear, image.texels, image.straight_alpha)
        chain.append(encoded(linear, image))
    return chain


def halved(image: np.ndarray, axis: int) -> np.ndarray:
    """Averages of pairs of texels along an axis; of the last three, if their number is odd."""
    *pairs, last = np.split(image, range(2, image.shape[axis] - 1, 2), axis)
    half = [(0.5 * (each.take([0], axis) + each.take([1], axis))).astype(np.float32) for each in pairs]
    count = np.float32(last.shape[axis])
    texels = [last.take([index], axis) for index in range(last.shape[axis])]
    return np.concatenate([*half, sum(texels[1:], texels[0]) / count], axis)
