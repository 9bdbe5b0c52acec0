# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the texels of Blender's images: of files, packed ones and generated ones."""

import os

import bpy
import numpy as np

from ....color import REC709, between_spaces, linear_from_srgb, srgb_from_linear
from ....scene import Encoding, Image

#: Spaces whose stored values are linear. Blender reads floating point images as linear, whatever their space.
LINEAR = ("Linear Rec.709", "Non-Color", "Raw")

MAX_FLOAT16 = 65504.0

#: Texels that are converted at a time: few enough for the processor's cache.
TEXELS_AT_A_TIME = 1 << 15

#: Spaces of byte images whose values are used unchanged. Values of other spaces have Rec.709's primaries.
DATA = ("Non-Color", "Raw")


#: Texels along a side of an image from which its mean colour is computed.
MEAN_TEXELS = 512


def working_space() -> str:
    """The linear space of all colours in the open file: since Blender 5.0 it can be another than Rec.709's."""
    return bpy.data.colorspace.working_space if bpy.app.version >= (5, 0) else REC709


def is_known_space(image: bpy.types.Image) -> bool:
    """Whether `texels` can convert from the image's colour space."""
    return image.is_float or image.colorspace_settings.name in ("sRGB", *LINEAR)


def origin(image: bpy.types.Image) -> tuple | None:
    """Equal for equal texels: what a packed image without later edits is decoded from. None for other images."""
    if image.source != "FILE" or image.packed_file is None or image.is_dirty:
        return None
    return image.packed_file.data, image.colorspace_settings.name, image.alpha_mode, working_space()


def encoding(image: bpy.types.Image) -> Encoding:
    """The encoding of `texels`: that of the stored image, or sRGB if colours are converted to another working space."""
    if image.is_float:
        return Encoding.FLOAT
    space = image.colorspace_settings.name
    keeps_values = space in DATA or (space in LINEAR and working_space() == REC709)
    return Encoding.LINEAR if keeps_values else Encoding.SRGB


def texels(image: bpy.types.Image, on_black: bool = False) -> np.ndarray | None:
    """(H,W,4) in the image's `encoding`, bottom row first; None if it has no pixels.

    Colours have the primaries of the working space, as floating point images already do.
    With `on_black`, colours are multiplied by alpha, as in Cycles when the image's alpha is not used.
    Unknown colour spaces are taken for sRGB.
    """
    width, height = image.size
    count = len(image.pixels)
    if count == 0 or width * height == 0:
        return None
    pixels: np.ndarray = np.empty(count, np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(width * height, -1)
    stored = np.empty((height, width, 4), encoding(image).dtype)
    rows = stored.reshape(-1, 4)
    for first in range(0, len(rows), TEXELS_AT_A_TIME):
        batch = slice(first, first + TEXELS_AT_A_TIME)
        rows[batch] = _encoded(image, _four_channels(pixels[batch]), on_black)
    return stored


def mean_texel(image: Image) -> np.ndarray:
    """(4,) mean of an image's linear colour and alpha, from about MEAN_TEXELS² texels."""
    step = max(max(image.texels.shape[:2]) // MEAN_TEXELS, 1)
    some = image.texels[::step, ::step]
    alpha = some[..., 3].mean(dtype=np.float64) / (1.0 if image.encoding is Encoding.FLOAT else 255.0)
    return np.append(linear(some[..., :3], image.encoding).mean((0, 1), dtype=np.float64), alpha)


def linear(stored: np.ndarray, encoded: Encoding) -> np.ndarray:
    """(H,W,3) float32: linear colours of texels."""
    if encoded is Encoding.FLOAT:
        return stored.astype(np.float32)
    values = np.arange(256, dtype=np.float32) / np.float32(255.0)
    return (linear_from_srgb(values) if encoded is Encoding.SRGB else values).astype(np.float32)[stored]


def texels_of_frame(image: bpy.types.Image, path: str, on_black: bool) -> np.ndarray | None:
    """The texels of one file of an image sequence. Blender does not give the texels of a sequence's frames."""
    if not os.path.isfile(path):
        return None
    with bpy.data.temp_data() as data:  # a new image in the open file would change all depsgraphs
        return _loaded(data, image, path, on_black)


def _loaded(data: bpy.types.BlendData, image: bpy.types.Image, path: str, on_black: bool) -> np.ndarray | None:
    frame = data.images.load(path)
    frame.colorspace_settings.name, frame.alpha_mode = image.colorspace_settings.name, image.alpha_mode
    return texels(frame, on_black)


def _encoded(image: bpy.types.Image, pixels: np.ndarray, on_black: bool) -> np.ndarray:
    """(N,4) texels from the values (N,4) of some of the image's pixels, which are overwritten."""
    color, alpha = pixels[:, :3], pixels[:, 3:]
    if on_black and _has_straight_alpha(image) and (alpha < 1.0).any():
        color *= alpha
    if image.is_float:
        alpha[:] = _clipped(alpha, 1.0)
        return _clipped(pixels, MAX_FLOAT16).astype(np.float16)
    space, working = image.colorspace_settings.name, working_space()
    if space not in DATA and working != REC709:
        linear = color if space in LINEAR else linear_from_srgb(color)
        color[:] = srgb_from_linear(_clipped(linear @ between_spaces(working, REC709).T, 1.0))
    pixels *= np.float32(255.0)
    pixels += np.float32(0.5)
    return pixels.astype(np.uint8)


def _clipped(values: np.ndarray, upper: float) -> np.ndarray:
    """Values clipped to 0 … `upper`; NaN becomes 0."""
    return np.clip(np.nan_to_num(values, nan=0.0), 0.0, upper)


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
    """Whether the colour is not yet multiplied by alpha; in floating point images it is."""
    is_data = image.colorspace_settings.is_data
    return not image.is_float and not is_data and image.alpha_mode in ("STRAIGHT", "PREMUL")
