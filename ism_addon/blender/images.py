# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's images, of a file, packed or generated, to sRGB-encoded texels."""

import bpy
import numpy as np

from ..color import srgb_from_linear

#: Spaces whose stored values are linear; Blender reads floating point images as linear whatever they say.
LINEAR = ("Linear Rec.709", "Non-Color", "Raw")


def is_known_space(image: bpy.types.Image) -> bool:
    """Whether `texels` knows what the image's numbers mean."""
    return image.is_float or image.colorspace_settings.name in ("sRGB", *LINEAR)


def texels(image: bpy.types.Image, on_black: bool = False) -> np.ndarray | None:
    """(H,W,4) uint8, sRGB-encoded, bottom row first; None where there is nothing to read.

    On black, what is transparent is dark, as where Cycles is not asked for an image's alpha.
    A space that is not known is taken for sRGB. Light beyond 1 is cut off.
    """
    width, height = image.size
    count = len(image.pixels)
    if count == 0 or width * height == 0:
        return None
    pixels = np.empty(count, np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, -1)
    color, alpha = _color_and_alpha(pixels)
    if on_black and _has_straight_alpha(image):
        color = color * alpha[..., None]
    if image.is_float or image.colorspace_settings.name in LINEAR:
        color = encoded(color)
    stored = np.empty((height, width, 4), np.uint8)
    stored[..., :3] = _bytes(color)
    stored[..., 3] = _bytes(alpha)
    return stored


def encoded(linear: np.ndarray) -> np.ndarray:
    """Linear values to sRGB's, within 0 to 1; what is no number is 0."""
    linear = np.clip(np.nan_to_num(linear, nan=0.0), 0.0, 1.0)
    return srgb_from_linear(linear)


def _color_and_alpha(pixels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(H,W,3 or 1) and (H,W) of images of one to four channels."""
    channels = pixels.shape[2]
    alpha = pixels[..., -1] if channels in (2, 4) else np.ones(pixels.shape[:2], np.float32)
    return pixels[..., : 3 if channels >= 3 else 1], alpha


def _has_straight_alpha(image: bpy.types.Image) -> bool:
    """Whether the colour is still to be multiplied by the alpha; in floating point images it is already."""
    is_data = image.colorspace_settings.is_data
    return not image.is_float and not is_data and image.alpha_mode in ("STRAIGHT", "PREMUL")


def _bytes(values: np.ndarray) -> np.ndarray:
    return (np.clip(np.nan_to_num(values, nan=0.0), 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)
