# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads uncompressed 32-bit OpenEXR files, which Blender writes for tests: it gives no other access to passes."""

import struct
from pathlib import Path

import numpy as np


def _text(raw: bytes, at: int) -> tuple[str, int]:
    end = raw.index(b"\0", at)
    return raw[at:end].decode(), end + 1


def _channels(raw: bytes) -> list[str]:
    names, at = [], 0
    while raw[at]:
        name, at = _text(raw, at)
        names.append(name)
        at += 16
    return names


def read(path: Path) -> dict[str, np.ndarray]:
    """Channel name ("ViewLayer.Depth.Z") to (H,W) float32, bottom row first."""
    raw, header, at = path.read_bytes(), {}, 8
    while raw[at]:
        name, at = _text(raw, at)
        _type, at = _text(raw, at)
        (size,) = struct.unpack_from("<i", raw, at)
        header[name] = raw[at + 4 : at + 4 + size]
        at += 4 + size
    assert header["compression"] == b"\0", "write the file without compression"
    left, top, right, bottom = struct.unpack("<4i", header["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    names = _channels(header["channels"])
    rows = np.empty((height, len(names), width), np.float32)
    for offset in struct.unpack_from(f"<{height}Q", raw, at + 1):
        row, size = struct.unpack_from("<2i", raw, offset)
        assert size == rows[0].nbytes, "write the file with 32 bits a channel"
        rows[row - top] = np.frombuffer(raw, "<f4", rows[0].size, offset + 8).reshape(rows[0].shape)
    return {name: rows[::-1, index] for index, name in enumerate(names)}
