# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's images, of a file, packed or generated, to texels."""

import os

import bpy
import numpy as np

from ....color import REC709, between_spaces, linear_from_srgb, srgb_from_linear
from ....scene import Encoding

#: Spaces whose stored values are linear; Blender reads floating point images as linear whatever they say.
LINEAR = ("Linear Rec.709", "Non-Color", "Raw")

MAX_FLOAT16 = 65504.0

#: Texels that are converted at a time: they stay in the processor's cache from step to step.
TEXELS_AT_A_TIME = 1 << 15


#: Spaces of byte images whose numbers are taken as they are; those of others are amounts of Rec.709's primaries.
DATA = ("Non-Color", "Raw")


def working_space() -> str:
    """The linear space of all colours in the open file: since Blender 5.0 it may be another than Rec.709's."""
    return bpy.data.colorspace.working_space if bpy.app.version >= (5, 0) else REC709


def is_known_space(image: bpy.types.Image) -> bool:
    """Whether `texels` knows what the image's numbers mean."""
    return image.is_float or image.colorspace_settings.name in ("sRGB", *LINEAR)


def origin(image: bpy.types.Image) -> tuple | None:
    """What makes an image's texels, where that is at hand: a packed file that nobody has painted on since."""
    if image.source != "FILE" or image.packed_file is None or image.is_dirty:
        return None
    return image.packed_file.data, image.colorspace_settings.name, image.alpha_mode, working_space()


def encoding(image: bpy.types.Image) -> Encoding:
    """Of `texels`: as the image is stored, but for colors that are converted to another working space."""
    if image.is_float:
        return Encoding.FLOAT
    space = image.colorspace_settings.name
    keeps_values = space in DATA or (space in LINEAR and working_space() == REC709)
    return Encoding.LINEAR if keeps_values else Encoding.SRGB


def texels(image: bpy.types.Image, on_black: bool = False) -> np.ndarray | None:
    """(H,W,4) of the image's `encoding`, bottom row first; None where there is nothing to read.

    Of amounts of the working space's primaries, which floating point images have already.
    On black, what is transparent is dark, as where Cycles is not asked for an image's alpha.
    A space that is not known is taken for sRGB.
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
        part = slice(first, first + TEXELS_AT_A_TIME)
        rows[part] = _stored(image, _four_channels(pixels[part]), on_black)
    return stored


def texels_of_frame(image: bpy.types.Image, path: str, on_black: bool) -> np.ndarray | None:
    """The same of a file of an image sequence: of the sequence itself, Blender tells the texels of no frame."""
    if not os.path.isfile(path):
        return None
    with bpy.data.temp_data() as apart:  # a new image in the open file would change all depsgraphs
        return _loaded(apart, image, path, on_black)


def _loaded(apart: bpy.types.BlendData, image: bpy.types.Image, path: str, on_black: bool) -> np.ndarray | None:
    frame = apart.images.load(path)
    frame.colorspace_settings.name, frame.alpha_mode = image.colorspace_settings.name, image.alpha_mode
    return texels(frame, on_black)


def _stored(image: bpy.types.Image, pixels: np.ndarray, on_black: bool) -> np.ndarray:
    """(N,4) texels of the image's own values (N,4) in some of its pixels, which are spoilt."""
    color, alpha = pixels[:, :3], pixels[:, 3:]
    if on_black and _has_straight_alpha(image) and (alpha < 1.0).any():
        color *= alpha
    if image.is_float:
        alpha[:] = _within_bounds(alpha, 1.0)
        return _within_bounds(pixels, MAX_FLOAT16).astype(np.float16)
    space, working = image.colorspace_settings.name, working_space()
    if space not in DATA and working != REC709:
        linear = color if space in LINEAR else linear_from_srgb(color)
        color[:] = srgb_from_linear(_within_bounds(linear @ between_spaces(working, REC709).T, 1.0))
    pixels *= np.float32(255.0)
    pixels += np.float32(0.5)
    return pixels.astype(np.uint8)


def _within_bounds(values: np.ndarray, most: float) -> np.ndarray:
    """Values from 0 to `most`; what is no number is 0."""
    return np.clip(np.nan_to_num(values, nan=0.0), 0.0, most)


def _four_channels(pixels: np.ndarray) -> np.ndarray:
    """(N,4) of pixels of one to four channels, which are themselves where they have four."""
    channels = pixels.shape[1]
    if channels == 4:
        return pixels
    four = np.ones((len(pixels), 4), np.float32)
    four[:, :3] = pixels[:, : 3 if channels == 3 else 1]
    if channels == 2:
        four[:, 3] = pixels[:, 1]
    return four


def _has_straight_alpha(image: bpy.types.Image) -> bool:
    """Whether the colour is still to be multiplied by the alpha; in floating point images it is already."""
    is_data = image.colorspace_settings.is_data
    return not image.is_float and not is_data and image.alpha_mode in ("STRAIGHT", "PREMUL")
