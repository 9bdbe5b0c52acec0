# SPDX-License-Identifier: GPL-3.0-or-later
"""Screenshots of the window as arrays, and measures of how two pictures differ."""

import shutil
import struct
import subprocess
from pathlib import Path

import bpy
import numpy as np

#: Crops a picture of an area: at its border Blender draws round corners and small arrows.
WITHOUT_BORDER = np.s_[20:-20, 20:-20]
MIN_DIFFERENCE = 0.1  # of display values: less is no difference, as at an edge that is smoothed differently


def screenshot(path: Path) -> np.ndarray:
    """Save the screen as a PNG: its (H,W,3) float32 display values from 0 to 1, top row first."""
    if shutil.which("import"):
        subprocess.run(["import", "-window", "root", "-define", "png:compression-level=1", str(path)], check=True)
    else:
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0]):
            bpy.ops.screen.screenshot(filepath=str(path))
    return read_png(path)


def read_png(path: Path) -> np.ndarray:
    """A PNG's display values: (H,W,3) float32 from 0 to 1, top row first."""
    if not shutil.which("convert"):
        return _read_by_blender(path)
    width, height = struct.unpack(">II", path.read_bytes()[16:24])
    read = subprocess.run(["convert", str(path), "-depth", "8", "rgb:-"], check=True, stdout=subprocess.PIPE)
    return np.frombuffer(read.stdout, np.uint8).reshape(height, width, 3).astype(np.float32) / 255


def _read_by_blender(path: Path) -> np.ndarray:
    """The same without ImageMagick; Blender takes it for a change of the scene."""
    image = bpy.data.images.load(str(path))
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    width, height = image.size
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, -1)[::-1, :, :3]


def rmse(one: np.ndarray, other: np.ndarray) -> float:
    """Root mean square error."""
    return float(np.sqrt(np.mean((one.astype(np.float64) - other) ** 2)))


def different_pixels(one: np.ndarray, other: np.ndarray) -> int:
    """How many pixels of either picture are outside the range of the other picture's 3×3 pixels there."""
    count = 0
    for picture, reference in ((one, other), (other, one)):
        neighbourhoods = np.lib.stride_tricks.sliding_window_view(_padded(reference), (3, 3), axis=(0, 1))
        low = neighbourhoods.min(axis=(-2, -1)) - MIN_DIFFERENCE
        high = neighbourhoods.max(axis=(-2, -1)) + MIN_DIFFERENCE
        count += int(((picture < low) | (picture > high)).any(axis=-1).sum())
    return count


def _padded(picture: np.ndarray) -> np.ndarray:
    return np.pad(picture, ((1, 1), (1, 1), (0, 0)), mode="edge")
