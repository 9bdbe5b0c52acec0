# SPDX-License-Identifier: GPL-3.0-or-later
"""Cuts a PNG file (ISO 15948) into files of some of its rows, so that Blender can decode a large one in bands.

Blender gives texels only of whole images, as 32-bit floats: 16384² of them take 4.3 GB. A row may be stored as
differences from the row above. So each band begins with the last row of the band above, as it was decoded.
"""

import struct
import zlib
from typing import BinaryIO

SIGNATURE = b"\x89PNG\r\n\x1a\n"

#: Channels of the types of colours that are supported: grey, RGB and RGBA.
CHANNELS = {0: 1, 2: 3, 6: 4}

#: Compressed bytes that are read at a time.
BYTES_AT_A_TIME = 1 << 16


class UnsupportedPng(ValueError):
    """The file is no PNG, is damaged, or of a type that cannot be cut. Blender decodes it as a whole."""


class LargePng:
    """A PNG of 8 bits a channel that is not interlaced."""

    def __init__(self, file: BinaryIO):
        """Reads the header. Raises UnsupportedPng."""
        if file.read(len(SIGNATURE)) != SIGNATURE:
            raise UnsupportedPng
        self._file = file
        self._left = self._checksum = 0  # of the current chunk with rows: bytes to read, and of those before
        type_, header = self._chunk()
        if type_ != b"IHDR" or len(header) != 13:
            raise UnsupportedPng
        self.width, self.height, depth, color, *rest = struct.unpack(">IIBBBBB", header)
        if depth != 8 or color not in CHANNELS or any(rest):
            raise UnsupportedPng
        self._color, self.channels = color, CHANNELS[color]
        while (chunk := self._chunk())[0] != b"IDAT":
            if chunk[0] == b"tRNS":
                raise UnsupportedPng
        self._stream, self._block = zlib.decompressobj(), b""

    def band(self, rows: int, above: bytes) -> bytes:
        """The next rows as a PNG, after the decoded row `above` them, or b"" for the first. Raises UnsupportedPng."""
        lines = self._inflated(rows * (1 + self.channels * self.width))
        if above:
            lines, rows = b"\0" + above + lines, rows + 1
        header = struct.pack(">IIBBBBB", self.width, rows, 8, self._color, 0, 0, 0)
        chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(lines, 0)), (b"IEND", b""))
        return SIGNATURE + b"".join(
            struct.pack(">I", len(data)) + type_ + data + struct.pack(">I", zlib.crc32(type_ + data))
            for type_, data in chunks
        )

    def _inflated(self, count: int) -> bytes:
        """The next bytes of the rows, which the file has compressed."""
        found = bytearray()
        try:
            while len(found) < count:
                more = self._stream.decompress(self._block, count - len(found))
                self._block = self._stream.unconsumed_tail or (b"" if more else self._next_block())
                found += more
        except zlib.error as reason:
            raise UnsupportedPng from reason
        return bytes(found)

    def _next_block(self) -> bytes:
        """The next compressed bytes, from one chunk or the next one."""
        while not self._left:
            if self._file.read(4) != struct.pack(">I", self._checksum):
                raise UnsupportedPng
            if self._chunk()[0] != b"IDAT":
                raise UnsupportedPng
        block = self._file.read(min(BYTES_AT_A_TIME, self._left))
        if not block:
            raise UnsupportedPng
        self._left, self._checksum = self._left - len(block), zlib.crc32(block, self._checksum)
        return block

    def _chunk(self) -> tuple[bytes, bytes]:
        """The type and the data of the next chunk; of one with rows, `_left` tells how much data follows."""
        start = self._file.read(8)
        if len(start) < 8:
            raise UnsupportedPng
        length, type_ = struct.unpack(">I4s", start)
        if type_ == b"IDAT":
            self._left, self._checksum = length, zlib.crc32(type_)
            return type_, b""
        return type_, self._file.read(length + 4)[:length]
