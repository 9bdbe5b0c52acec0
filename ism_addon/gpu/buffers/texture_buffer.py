# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of materials on the GPU."""

from collections.abc import Iterable

import moderngl
import numpy as np

from ...scene import Encoding, Image, texel_files
from ...setting_limits import LAYER_LINES, TEXTURE_WIDTH, images_within_limits, level, lines_for
from ..gl import driver_variants
from ..gl.buffer_texture import BufferTexture
from ..gl.context import Device
from ..gl.shader_records import IMAGE
from .mip_levels import mip_levels

#: Types of texels by the sampler's name.
TEXELS: dict[str, np.dtype] = {"byte_texels": np.dtype(np.uint8), "float_texels": np.dtype(np.float16)}


class TextureBuffer:
    """All images with their mip levels, in one texture of 8-bit texels and one of 16-bit floats, line after line.

    If they exceed a limit, the largest are halved. A texture has several layers if one cannot hold all lines.
    """

    def __init__(self, device: Device, images: tuple[Image, ...]):
        self.images = images
        table = np.zeros(len(images), IMAGE.dtype)
        self.bytes = table.nbytes
        #: By the sampler's name; only of texels that any image has.
        self.textures: dict[str, moderngl.TextureArray] = {}
        halvings = images_within_limits(images)
        for name, dtype in TEXELS.items():
            chosen = [each for each in zip(table, images, halvings, strict=True) if each[1].texels.dtype == dtype]
            if not chosen:
                continue
            ends = np.cumsum([0] + [lines_for(image.texels.shape[:2], first) for _, image, first in chosen]).tolist()
            self.textures[name] = texture = _texture(device, ends[-1], dtype)
            for line, (row, image, first) in zip(ends[:-1], chosen, strict=True):
                row["encoding"], row["repeat"] = list(Encoding).index(image.encoding), image.repeat
                row["scale"] = image.scale
                row["first_line"], row["levels"] = line, max(image.texels.shape[:2]).bit_length() - first
                row["height"], row["width"] = level(image.texels.shape, first)
                self.bytes += _write(texture, line, image, first)
        #: Rows of IMAGE.
        self.rows = with_levels(table)
        self.table = IMAGE.upload(device, self.rows)

    @property
    def samplers(self) -> dict[str, moderngl.TextureArray | BufferTexture]:
        """The table and the textures by sampler name in textures/image.glsl."""
        return {"images": self.table, **self.textures}


def image_constants(images: Iterable[Image]) -> dict[str, int]:
    """Constants of shaders that read the TextureBuffer of images: the size of layers, and which texels are present."""
    present = {image.texels.dtype for image in images}
    return {"width": TEXTURE_WIDTH, "layer_lines": LAYER_LINES} | {
        f"has_{name}": int(dtype in present) for name, dtype in TEXELS.items()
    }


def with_levels(images: np.ndarray) -> np.ndarray:
    """Rows of IMAGE for images (N,), and after them for the mip levels of each."""
    levels = np.zeros(int(images["levels"].sum()), IMAGE.dtype)
    images["first_level"] = len(images) + np.cumsum(images["levels"]) - images["levels"]
    for image in images:
        own = levels[image["first_level"] - len(images) :][: image["levels"]]
        for axis in ("width", "height"):
            own[axis] = np.maximum(image[axis] >> np.arange(image["levels"]), 1)
        own["first_line"] = np.cumsum(own["width"] * own["height"]) - own["width"] * own["height"]
    return np.concatenate([images, levels])


def _texture(device: Device, lines: int, dtype: np.dtype) -> moderngl.TextureArray:
    """A texture of at least so many lines, not a power of two, for which llvmpipe would compile other variants."""
    layers = -(-lines // LAYER_LINES)
    size = TEXTURE_WIDTH, LAYER_LINES if layers > 1 else max(3, lines | 1), layers
    texture = device.gl.texture_array(size, 4, dtype=f"f{dtype.itemsize}")
    driver_variants.never_filtered(texture)
    return texture


def _write(texture: moderngl.TextureArray, line: int, image: Image, first: int) -> int:
    """Write an image's mip levels from level `first` on, each after the one before, from a line on. Returns bytes."""
    levels = range(first, max(image.texels.shape[:2]).bit_length())
    counts = [height * width for height, width in (level(image.texels.shape, each) for each in levels)]
    starts = dict(zip(levels, np.cumsum([line * TEXTURE_WIDTH, *counts[:-1]]).tolist(), strict=True))
    for each, offset, texels in mip_levels(image):
        if each in starts:
            _write_texels(texture, starts[each] + offset, texels)
        if each == 0:
            texel_files.release_memory(image.texels)
    return sum(counts) * 4 * image.texels.itemsize


def _write_texels(texture: moderngl.TextureArray, first: int, texels: np.ndarray) -> None:
    """Write texels (N,4) from the texture's texel `first` on: parts of lines, and complete lines of a layer at once."""
    done = 0
    while done < len(texels):
        line, column = divmod(first + done, TEXTURE_WIDTH)
        layer, line = divmod(line, LAYER_LINES)
        width = min(TEXTURE_WIDTH - column, len(texels) - done)
        lines = min((len(texels) - done) // TEXTURE_WIDTH, LAYER_LINES - line) if width == TEXTURE_WIDTH else 1
        portion = np.ascontiguousarray(texels[done : done + lines * width])
        texture.write(portion, viewport=(column, line, layer, width, lines, 1))
        done += lines * width
