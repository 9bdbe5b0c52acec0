# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the texels of Blender's images: of files, packed ones and generated ones."""

import io
import math
import os
from contextlib import suppress
from functools import partial
from typing import BinaryIO

import bpy
import numpy as np

from ....color import REC709, between_spaces, linear_from_srgb, srgb_from_linear
from ....half_floats import MAX_HALF, halves
from ....parallel import parallel_map
from ....scene import Encoding, Image, texel_files
from .large_png import LargePng, UnsupportedPng

#: Spaces whose stored values are linear. Blender reads floating point images as linear, whatever their space.
LINEAR = ("Linear Rec.709", "Non-Color", "Raw")

#: The largest texel: with larger ones, those around 1 would be rounded visibly.
MAX_TEXEL = MAX_HALF * 2.0**15

#: As integers, the bits of the largest texel and of alpha.
BITS_OF_MAX_TEXEL, BITS_OF_1 = np.array([MAX_TEXEL, 1.0], np.float32).view(np.uint32)

#: Texels that are converted at a time: few enough for the processor's cache, and so many that threads seldom wait for
#: one another between numpy's steps.
TEXELS_AT_A_TIME = 1 << 17

#: Texels of rows, at most, of which extremes are found at once.
ROW_TEXELS = 256

#: Images of more texels are decoded in bands if possible. Blender gives texels as floats, four times their memory.
TEXELS_AT_ONCE = 1 << 26

#: Texels of a band: at least a row of any image.
BAND_TEXELS = 1 << 22

#: Modes of alpha in which Blender keeps the values that a PNG stores.
UNCHANGED = "STRAIGHT", "CHANNEL_PACKED"

#: Spaces of byte images whose values are used unchanged. Values of other spaces have Rec.709's primaries.
DATA = ("Non-Color", "Raw")

#: Texels along a side of an image from which its mean colour is computed.
MEAN_TEXELS = 128


def working_space() -> str:
    """The linear space of all colours in the open file: since Blender 5.0 it can be another than Rec.709's."""
    return bpy.data.colorspace.working_space if bpy.app.version >= (5, 0) else REC709


def is_known_space(image: bpy.types.Image, encoding: Encoding) -> bool:
    """Whether `read`, which found this encoding, can convert from the image's colour space."""
    return encoding is Encoding.FLOAT or image.colorspace_settings.name in ("sRGB", *LINEAR)


def origin(image: bpy.types.Image) -> tuple | None:
    """Equal for equal texels: of images without later edits, what they are decoded from. None for other images."""
    if image.source != "FILE" or image.is_dirty:
        return None
    packed = image.packed_file
    file = _file_state(image) if packed is None else (packed.size, hash(packed.data))
    return (file, image.colorspace_settings.name, image.alpha_mode, working_space()) if file else None


def _path(image: bpy.types.Image) -> str:
    return bpy.path.abspath(image.filepath, library=image.library)


def _file_state(image: bpy.types.Image) -> tuple | None:
    """The state of an image's file. None if Blender may have decoded an earlier one, or there is no file."""
    path = _path(image)
    if image.has_data or not os.path.isfile(path):
        return None
    state = os.stat(path)
    return path, state.st_mtime_ns, state.st_size


def read(image: bpy.types.Image, repeat: bool = True, on_black: bool = False) -> Image | None:
    """An image; None if it has no pixels.

    Its encoding is that of the stored image, or sRGB if colours are converted to another working space. Colours have
    the primaries of the working space, as floating point images already do.
    With `on_black`, colours are multiplied by alpha, as in Cycles when the image's alpha is not used.
    Unknown colour spaces are taken for sRGB.
    """
    with suppress(UnsupportedPng, OSError), _file(image) as file:
        png = LargePng(file)
        if png.width * png.height > TEXELS_AT_ONCE and (png.channels < 4 or image.alpha_mode in UNCHANGED):
            texels, passes = _texels_of_bands(image, png, on_black)
            is_straight = passes and not on_black and _has_straight_alpha(image)
            return Image(texels, repeat, _encoding(image, is_float=False), is_straight)
    width, height = image.size
    if len(image.pixels) == 0 or width * height == 0:
        return None
    encoding = _encoding(image, image.is_float)
    texels = texel_files.empty((height, width, 4), encoding.dtype)
    if image.is_float:
        return Image(texels, repeat, encoding, scale=_encode_floats(_pixels(image), texels))
    passes = _encode_bytes(image, _pixels(image), texels, on_black)
    return Image(texels, repeat, encoding, passes and not on_black and _has_straight_alpha(image))


def _file(image: bpy.types.Image) -> BinaryIO:
    """The file that Blender decodes an image from, which it has not done yet or will do again. Raises OSError."""
    if image.source != "FILE" or image.is_dirty:
        raise FileNotFoundError
    if image.packed_file is not None:
        return io.BytesIO(image.packed_file.data)
    if image.has_data:  # maybe of an earlier file
        raise FileNotFoundError
    return open(_path(image), "rb")


def _texels_of_bands(image: bpy.types.Image, png: LargePng, on_black: bool) -> tuple[np.ndarray, bool]:
    """The texels of a PNG that Blender decodes in bands, from the top, and as _encode_bytes. Raises UnsupportedPng."""
    texels = texel_files.empty((png.height, png.width, 4), np.dtype(np.uint8))
    above, bottom, passes = b"", png.height, False
    with bpy.data.temp_data() as data:
        while bottom > 0:
            top = max(bottom - BAND_TEXELS // png.width, 0)
            band, file = data.images.new("Band", 1, 1), png.band(bottom - top, above)
            band.pack(data=file, data_len=len(file))
            band.source, band.alpha_mode = "FILE", image.alpha_mode
            band.colorspace_settings.name = image.colorspace_settings.name
            if tuple(band.size) != (png.width, bottom - top + bool(above)):
                raise UnsupportedPng
            pixels = _pixels(band)
            above = np.rint(pixels[: png.width, : png.channels] * np.float32(255.0)).astype(np.uint8).tobytes()
            passes |= _encode_bytes(band, pixels, texels[top:bottom], on_black)
            data.images.remove(band)
            bottom = top
    return texels, passes


def _pixels(image: bpy.types.Image) -> np.ndarray:
    """(N,channels) float32 from Blender, bottom row first."""
    width, height = image.size
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(width * height, -1)


def _encode_bytes(image: bpy.types.Image, pixels: np.ndarray, texels: np.ndarray, on_black: bool) -> bool:
    """Fill bytes (H,W,4) from the first of the pixels (N,channels), which are overwritten.

    Returns whether alpha is below 1 anywhere.
    """
    rows, space, working = texels.reshape(-1, 4), image.colorspace_settings.name, working_space()
    multiplies = on_black and _has_straight_alpha(image)

    def fill(batch: slice) -> bool:  # reads nothing of Blender
        rows[batch] = _encoded(_four_channels(pixels[: len(rows)][batch]), multiplies, space, working)
        return bool((rows[batch, 3] < 255).any())

    passes = any(parallel_map(fill, _batches(len(rows)), len(rows)))
    texel_files.release_memory(texels)
    return passes


def _encode_floats(pixels: np.ndarray, texels: np.ndarray) -> float:
    """Fill 16-bit floats (H,W,4) from pixels (N,channels), which are overwritten. Returns Image.scale."""
    rows, batches = texels.reshape(-1, 4), _batches(texels.size // 4)

    def fill(batch: slice, scale: float = 1.0) -> float:
        values = _four_channels(pixels[batch])
        largest = _limit_floats(values)
        if scale != 1.0:
            values[:, :3] /= np.float32(scale)
        if largest <= MAX_HALF * scale:
            halves(values, rows[batch])
        return largest

    largest, scale = max(parallel_map(fill, batches, len(rows))), 1.0
    if largest > MAX_HALF:
        scale = 2.0 ** math.ceil(math.log2(largest / MAX_HALF))
        parallel_map(partial(fill, scale=scale), batches, len(rows))
    texel_files.release_memory(texels)
    return scale


def _batches(count: int) -> list[slice]:
    """Portions of so many texels."""
    return [slice(first, first + TEXELS_AT_A_TIME) for first in range(0, count, TEXELS_AT_A_TIME)]


def read_frame(image: bpy.types.Image, path: str, repeat: bool, on_black: bool) -> Image | None:
    """One file of an image sequence. Blender does not give the texels of a sequence's frames."""
    if not os.path.isfile(path):
        return None
    with bpy.data.temp_data() as data:  # a new image in the open file would change all depsgraphs
        frame = data.images.load(path)
        frame.colorspace_settings.name, frame.alpha_mode = image.colorspace_settings.name, image.alpha_mode
        return read(frame, repeat, on_black)


def mean_texel(image: Image) -> np.ndarray:
    """(4,) mean of an image's linear colour and alpha, from about MEAN_TEXELS² texels."""
    step = max(max(image.texels.shape[:2]) // MEAN_TEXELS, 1)
    some = image.texels[::step, ::step].reshape(-1, 4)
    if image.encoding is Encoding.FLOAT:
        mean = some.mean(0, dtype=np.float64) * (*3 * (image.scale,), 1.0)
    else:  # by how many texels have each value, as converting each takes longer
        values = *3 * (_linear_values(image.encoding),), _linear_values(Encoding.LINEAR)
        counts = (np.bincount(channel, minlength=256) for channel in some.T)
        mean = np.array([count @ value for count, value in zip(counts, values, strict=True)]) / len(some)
    texel_files.release_memory(image.texels)
    return mean


def linear(image: Image) -> np.ndarray:
    """(H,W,3) float32: linear colours of texels."""
    stored = image.texels[..., :3]
    if image.encoding is Encoding.FLOAT:
        return stored.astype(np.float32) * np.float32(image.scale)
    return _linear_values(image.encoding).astype(np.float32)[stored]


def _linear_values(encoding: Encoding) -> np.ndarray:
    """(256,) float64: what the values of 8 bits mean."""
    values = np.arange(256) / 255.0
    return linear_from_srgb(values) if encoding is Encoding.SRGB else values


def _encoding(image: bpy.types.Image, is_float: bool) -> Encoding:
    if is_float:
        return Encoding.FLOAT
    space = image.colorspace_settings.name
    keeps_values = space in DATA or (space in LINEAR and working_space() == REC709)
    return Encoding.LINEAR if keeps_values else Encoding.SRGB


def _limit_floats(pixels: np.ndarray) -> float:
    """Limit pixels (N,4) in place to what Image can store; what is not finite becomes 0, as in Cycles.

    Returns the largest absolute value.
    """
    bits = _greatest(pixels.view(np.uint32))  # as integers, positive floats are in order, all others above them
    if bits.max() <= BITS_OF_MAX_TEXEL and bits[3] <= BITS_OF_1:
        return float(bits.max().view(np.float32))
    low, high = -_greatest(-pixels), _greatest(pixels)
    if not np.isfinite((low, high)).all():
        np.nan_to_num(pixels, copy=False, nan=0.0, posinf=0.0, neginf=0.0)
        low, high = -_greatest(-pixels), _greatest(pixels)
    largest = max(-low.min(), high.max())
    if low[3] < 0.0 or high[3] > 1.0:
        np.clip(pixels[:, 3], 0.0, 1.0, out=pixels[:, 3])
    if largest > MAX_TEXEL:
        np.clip(pixels, -MAX_TEXEL, MAX_TEXEL, out=pixels)
    return float(min(largest, MAX_TEXEL))


def _greatest(values: np.ndarray) -> np.ndarray:
    """(4,) greatest of values (N,4); NaN where any is. Of long rows first, which numpy compares at once."""
    rows = values.reshape(-1, 4 * math.gcd(len(values), ROW_TEXELS))
    greatest: np.ndarray = rows.max(0).reshape(-1, 4).max(0)
    return greatest


def _encoded(pixels: np.ndarray, multiplies: bool, space: str, working: str) -> np.ndarray:
    """(N,4) texels from the values (N,4) of some pixels of an image of bytes. The values are overwritten.

    `multiplies`: whether colors are multiplied by alpha; `space`: the image's, `working`: the scene's.
    """
    color, alpha = pixels[:, :3], pixels[:, 3:]
    if multiplies and (alpha < 1.0).any():
        color *= alpha
    if space not in DATA and working != REC709:
        linear = color if space in LINEAR else linear_from_srgb(color)
        color[:] = srgb_from_linear(_clipped(linear @ between_spaces(working, REC709).T, 1.0))
    pixels *= np.float32(255.0)
    pixels += np.float32(0.5)
    return pixels.astype(np.uint8)


def _clipped(values: np.ndarray, upper: float) -> np.ndarray:
    """Values clipped to 0 … `upper`; NaN becomes 0."""
    return np.fmin(np.fmax(values, np.float32(0.0)), np.float32(upper))


def _four_channels(pixels: np.ndarray) -> np.ndarray:
    """(N,4) from pixels of one to four channels; the same array if they have four."""
    channels = pixels.shape[1]
    if channels == 4:
        return pixels
    four = np.ones((len(pixels), 4), np.float32)
    four[:, :3] = pixels[:, : 3 if channels == 3 else 1]
    if channels == 2:
        four[:, 3] = pixels[:, 1]
    return four


def _has_straight_alpha(image: bpy.types.Image) -> bool:
    """Whether the colour of an image of bytes is not yet multiplied by alpha; in floating point images it is."""
    return not image.colorspace_settings.is_data and image.alpha_mode in ("STRAIGHT", "PREMUL")
