# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scene's meshes are made of, on the GPU."""

import numpy as np

from ...color import linear_from_srgb, srgb_from_linear
from ...scene import Image, Materials
from ...setting_limits import TEXTURE_WIDTH, images_within_limits, level
from ..gl import driver_variants
from ..gl.context import Device
from ..gl.shader_records import MATERIAL

SRGB8_ALPHA8 = 0x8C43


class TextureBuffer:
    """All images, with their halved copies, in one texture of texels. Where there are too many, the copies alone."""

    def __init__(self, device: Device, images: tuple[Image, ...]):
        self.images = images
        halved = images_within_limits(images)
        chains = [mip_chain(image.texels)[times:] for image, times in zip(images, halved, strict=True)]
        blocks = [padded(np.concatenate(chain)) for chain in chains]
        self.first_lines = np.cumsum([0] + [len(block) // TEXTURE_WIDTH for block in blocks])
        self.levels = [len(chain) for chain in chains]
        self.sizes = [level(image.texels.shape[:2], times) for image, times in zip(images, halved, strict=True)]
        # A texture, as arrays know no sRGB.
        size = TEXTURE_WIDTH, lines_for(int(self.first_lines[-1]))
        self.texture = device.gl.texture(size, 4, dtype="f1", internal_format=SRGB8_ALPHA8)
        driver_variants.never_filtered(self.texture)
        for block, line in zip(blocks, self.first_lines[:-1], strict=True):
            self.texture.write(block, viewport=(0, int(line), TEXTURE_WIDTH, len(block) // TEXTURE_WIDTH))
        self.bytes = sum(block.nbytes for block in blocks)


class MaterialBuffers:
    """Materials as a table that leads into the images' texels."""

    def __init__(self, device: Device, materials: Materials, texels: TextureBuffer):
        table = np.zeros(len(materials.base_color), MATERIAL.dtype)
        table["color"] = materials.base_color
        for row in np.flatnonzero(materials.image >= 0):
            number = materials.image[row]
            table[row]["first_line"], table[row]["levels"] = texels.first_lines[number], texels.levels[number]
            table[row]["height"], table[row]["width"] = texels.sizes[number]
            table[row]["repeat"] = texels.images[number].repeat
        self.table = MATERIAL.upload(device, table)
        self.texels = texels
        self.bytes = table.nbytes


def lines_for(lines: int) -> int:
    """As many or more: never a power of two, for which Mesa's software driver would compile every shader once more."""
    return max(3, lines | 1)


def padded(texels: np.ndarray) -> np.ndarray:
    """Texels (N,4) with empty ones behind, up to a whole line of the texture: floats count lines exactly."""
    return np.pad(texels, ((0, -len(texels) % TEXTURE_WIDTH), (0, 0)))


def mip_chain(texels: np.ndarray) -> list[np.ndarray]:
    """An image (H,W,4) uint8 and its halved copies down to one texel, each as rows of texels (N,4) uint8.

    Averages are taken in linear light, on 16 bits. An odd last row or column joins its neighbour.
    """
    decode = linear_from_srgb(np.arange(256) / 255.0).astype(np.float32)
    encode = np.rint(srgb_from_linear(np.arange(65536) / 65535.0) * 255.0).astype(np.uint8)
    chain = [texels.reshape(-1, 4)]
    linear = decode[texels]
    linear[..., 3] = texels[..., 3] / np.float32(255.0)
    while linear.shape[0] > 1 or linear.shape[1] > 1:
        for axis in (0, 1):
            if linear.shape[axis] > 1:
                linear = halved(linear, axis)
        level = encode[(linear * np.float32(65535.0) + np.float32(0.5)).astype(np.uint16)]
        level[..., 3] = np.rint(linear[..., 3] * 255.0)
        chain.append(level.reshape(-1, 4))
    return chain


def halved(image: np.ndarray, axis: int) -> np.ndarray:
    """Averages of neighbours along an axis; of the last three, if their number is odd."""
    image = np.moveaxis(image, axis, 0)
    pairs = len(image) // 2 * 2
    half = (image[0:pairs:2] + image[1:pairs:2]) * np.float32(0.5)
    if len(image) > pairs:
        half[-1] = (image[pairs - 2] + image[pairs - 1] + image[pairs]) / np.float32(3.0)
    return np.moveaxis(half, 0, axis)
