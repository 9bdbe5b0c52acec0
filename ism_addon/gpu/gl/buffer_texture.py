# SPDX-License-Identifier: GPL-3.0-or-later
"""Buffer textures: arrays that shaders read by index. moderngl does not offer them.

Any range of rows can be written, and software drivers read them faster than 2D textures.
"""

import ctypes
import weakref
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import cast

import moderngl
import numpy as np

from . import driver_variants
from .bound_state import MODERNGL_UNIT

TEXTURE_BUFFER = 0x8C2A
TEXTURE0 = 0x84C0

#: OpenGL's internal formats, by dtype and components of a row.
FORMATS = {
    ("f4", 1): 0x822E,
    ("f4", 2): 0x8230,
    ("f4", 4): 0x8814,
    ("u4", 1): 0x8236,
    ("u4", 4): 0x8D70,
    ("i2", 2): 0x8239,
}


class BufferTextureApi:
    """OpenGL's functions for buffer textures, in one context."""

    def __init__(self, load: Callable[[str], int], max_rows: int):
        """`load` gives the addresses of OpenGL's functions; `max_rows` is GL_MAX_TEXTURE_BUFFER_SIZE."""
        self.max_rows = max_rows
        name, names = ctypes.c_uint, ctypes.POINTER(ctypes.c_uint)
        self._generate = ctypes.CFUNCTYPE(None, ctypes.c_int, names)(load("glGenTextures"))
        self._delete = ctypes.CFUNCTYPE(None, ctypes.c_int, names)(load("glDeleteTextures"))
        self._activate = ctypes.CFUNCTYPE(None, name)(load("glActiveTexture"))
        self._bind = ctypes.CFUNCTYPE(None, name, name)(load("glBindTexture"))
        self._attach = ctypes.CFUNCTYPE(None, name, name, name)(load("glTexBuffer"))
        self._set_uniform = ctypes.CFUNCTYPE(None, name, ctypes.c_int, ctypes.c_int)(load("glProgramUniform1i"))
        #: Textures whose owners are gone. Owners may be freed in other threads, where OpenGL must not be called.
        self._released: deque[int] = deque()

    def create(self, owner: object, buffer: moderngl.Buffer, format: int) -> int:
        """OpenGL's name of a new texture over a buffer. It is deleted after its owner."""
        texture = ctypes.c_uint()
        self._generate(1, texture)
        self.use(texture.value, MODERNGL_UNIT)
        self._attach(TEXTURE_BUFFER, format, buffer.glo)
        weakref.finalize(owner, self._released.append, texture.value).atexit = False
        return texture.value

    def use(self, texture: int, unit: int) -> None:
        """Bind it to a texture unit."""
        self._activate(TEXTURE0 + unit)
        self._bind(TEXTURE_BUFFER, texture)

    def set_sampler(self, program: moderngl.Program, name: str, unit: int) -> None:
        """Let a sampler of a program read from a texture unit."""
        self._set_uniform(program.glo, cast(moderngl.Uniform, program[name]).location, unit)

    def free_released(self) -> None:
        """Delete textures whose owners are gone."""
        while self._released:
            self._delete(1, ctypes.c_uint(self._released.popleft()))


class BufferTexture:
    """A buffer of `count` rows, which a samplerBuffer, isamplerBuffer or usamplerBuffer reads row by row."""

    def __init__(self, gl: moderngl.Context, textures: BufferTextureApi, count: int, components: int, dtype: str):
        row = np.dtype(dtype).itemsize * components
        self.bytes = row * driver_variants.rows(count, row)
        self.row, self.count = row, count
        self.buffer = gl.buffer(reserve=self.bytes)
        self._textures = textures
        self._texture = textures.create(self, self.buffer, FORMATS[dtype, components])

    def write(self, rows: np.ndarray, first: int = 0) -> None:
        """Write rows, beginning at row `first`."""
        if len(rows):
            self.buffer.write(np.ascontiguousarray(rows), offset=first * self.row)

    def use(self, location: int) -> None:
        """Bind it to a texture unit."""
        self._textures.use(self._texture, location)

    def set_sampler(self, program: moderngl.Program, name: str, unit: int) -> None:
        """Let a sampler of a program read from a texture unit."""
        self._textures.set_sampler(program, name, unit)


class GrowingBuffer:
    """A buffer texture to which rows are appended. If it is full, a larger one replaces it."""

    def __init__(self, gl: moderngl.Context, allocate: Callable[[int], BufferTexture], max_rows: int):
        """`allocate` makes a buffer texture with a number of rows, at most `max_rows`."""
        self._gl, self._allocate, self._max_rows = gl, allocate, max_rows
        self.texture, self.count = allocate(0), 0

    def reserve(self, more: int) -> None:
        """Make room for `more` rows. Growth is by at least half, except for the first time."""
        needed = self.count + more
        if needed > self.texture.count:
            larger = self._allocate(max(needed, min(self.count + self.count // 2, self._max_rows)))
            if self.count:
                self._gl.copy_buffer(larger.buffer, self.texture.buffer, self.count * self.texture.row)
            self.texture = larger

    def append(self, rows: np.ndarray) -> None:
        """Append rows, for which room has been reserved."""
        self.texture.write(rows, self.count)
        self.count += len(rows)


@dataclass(eq=False)
class RecordTable:
    """A table of SceneRecords: consecutive rows of one record. It moves if another table needs more room."""

    buffer: BufferTexture
    first: int  # its first texel, a multiple of row_texels
    room: int  # texels
    row_texels: int
    bytes: int = 0  # that were written

    @property
    def first_row(self) -> int:
        """Its first row, in a buffer that has only rows of its record: shaders add it to the index of a row."""
        return self.first // self.row_texels


class SceneRecords:
    """The tables of one renderer's scene in one buffer texture: shaders read all of them with one sampler.

    A table is written again when it changes, which does not touch the others. If it is new or needs more room, the GPU
    copies the others to a new buffer. A table exists as long as anything refers to it.
    """

    def __init__(self, gl: moderngl.Context, allocate: Callable[[int], BufferTexture]):
        """`allocate` makes a buffer texture with a number of texels of four words."""
        self._gl, self._allocate = gl, allocate
        self._tables: weakref.WeakValueDictionary[str, RecordTable] = weakref.WeakValueDictionary()

    def write(self, name: str, words: np.ndarray, row_texels: int) -> RecordTable:
        """Write all rows of a table: words (N,4) uint32, `row_texels` texels a row."""
        table = self._tables.get(name)
        if table is None or table.room < len(words):
            table = self._with_room(name, len(words), row_texels)
        table.buffer.write(words, table.first)
        table.bytes = words.nbytes
        return table

    def _with_room(self, name: str, texels: int, row_texels: int) -> RecordTable:
        """A new table with room for so many texels, at the beginning of a new buffer to which all others move."""
        others = [table for other, table in self._tables.items() if other != name]
        firsts, end = [], texels
        for table in others:
            firsts.append(-(-end // table.row_texels) * table.row_texels)
            end = firsts[-1] + table.room
        buffer = self._allocate(end)
        for table, first in zip(others, firsts, strict=True):
            if table.bytes:
                offsets = {"read_offset": table.first * buffer.row, "write_offset": first * buffer.row}
                self._gl.copy_buffer(buffer.buffer, table.buffer.buffer, table.bytes, **offsets)
            table.buffer, table.first = buffer, first
        self._tables[name] = table = RecordTable(buffer, 0, texels, row_texels)
        return table
