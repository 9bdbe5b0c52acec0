# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes PNG files with the standard library: Blender has no image library for Python."""

import struct
import zlib
from pathlib import Path

import numpy as np

from ...atomic_files import atomic_write
from ...color import srgb_from_linear


def display_from_linear(color: np.ndarray) -> np.ndarray:
    """(H,W,4) uint8 sRGB with straight alpha, of linear light with premultiplied alpha: Blender's "Standard" view."""
    alpha = np.clip(color[..., 3:], 0.0, 1.0)
    linear = np.clip(color[..., :3] / np.where(alpha > 0.0, alpha, 1.0), 0.0, 1.0)
    return np.rint(np.concatenate([srgb_from_linear(linear), alpha], -1) * 255.0).astype(np.uint8)


def write_png(path: Path, pixels: np.ndarray) -> None:
    """Write (H,W,4) uint8, bottom row first, as a PNG of 8-bit RGBA (ISO 15948). Raises OSError."""
    height, width = pixels.shape[:2]
    lines = np.zeros((height, 1 + 4 * width), np.uint8)  # each begins with its filter type, 0: none
    lines[:, 1:] = pixels[::-1].reshape(height, -1)

    def chunk(type_: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + type_ + data + struct.pack(">I", zlib.crc32(type_ + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    with atomic_write(path) as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for type_, data in ((b"IHDR", header), (b"IDAT", zlib.compress(lines.tobytes(), 6)), (b"IEND", b"")):
            file.write(chunk(type_, data))
