# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays that shaders fetch from by number: OpenGL's buffer textures, which moderngl leaves out.

They can be written anywhere, and processors fetch from them sooner than from textures that have lines.
"""

import ctypes
import weakref
from collections import deque
from collections.abc import Callable
from typing import cast

import moderngl
import numpy as np

from . import driver_variants
from .bound_state import MODERNGL_UNIT

TEXTURE_BUFFER = 0x8C2A
TEXTURE0 = 0x84C0

#: OpenGL's internal formats, by numpy's type and how many of them a row has.
FORMATS = {
    ("f4", 1): 0x822E,
    ("f4", 2): 0x8230,
    ("f4", 4): 0x8814,
    ("u4", 1): 0x8236,
    ("u4", 4): 0x8D70,
    ("i2", 2): 0x8239,
}


class BufferTextureApi:
    """What OpenGL offers for them, in one context."""

    def __init__(self, load: Callable[[str], int], most: int):
        """`load` gives the addresses of OpenGL's functions, `most` is how many rows an array may have."""
        self.most = most
        name, names = ctypes.c_uint, ctypes.POINTER(ctypes.c_uint)
        self._generate = ctypes.CFUNCTYPE(None, ctypes.c_int, names)(load("glGenTextures"))
        self._delete = ctypes.CFUNCTYPE(None, ctypes.c_int, names)(load("glDeleteTextures"))
        self._activate = ctypes.CFUNCTYPE(None, name)(load("glActiveTexture"))
        self._bind = ctypes.CFUNCTYPE(None, name, name)(load("glBindTexture"))
        self._attach = ctypes.CFUNCTYPE(None, name, name, name)(load("glTexBuffer"))
        self._tell = ctypes.CFUNCTYPE(None, name, ctypes.c_int, ctypes.c_int)(load("glProgramUniform1i"))
        #: Of textures that nobody has any more: that may be so in another thread, where OpenGL must not be called.
        self._let_go: deque[int] = deque()

    def create(self, owner: object, buffer: moderngl.Buffer, format: int) -> int:
        """The name of a texture of a buffer, for as long as there is its owner."""
        made = ctypes.c_uint()
        self._generate(1, made)
        self.use(made.value, MODERNGL_UNIT)
        self._attach(TEXTURE_BUFFER, format, buffer.glo)
        weakref.finalize(owner, self._let_go.append, made.value).atexit = False
        return made.value

    def use(self, texture: int, unit: int) -> None:
        """Put it where a sampler may find it."""
        self._activate(TEXTURE0 + unit)
        self._bind(TEXTURE_BUFFER, texture)

    def tell(self, program: moderngl.Program, name: str, unit: int) -> None:
        """Where a sampler of a program finds its texture."""
        self._tell(program.glo, cast(moderngl.Uniform, program[name]).location, unit)

    def collect(self) -> None:
        """Free those whose owner is gone."""
        while self._let_go:
            self._delete(1, ctypes.c_uint(self._let_go.popleft()))


class BufferTexture:
    """Room on the GPU for (count, components) numbers, which a samplerBuffer, or one of integers, reads row by row."""

    def __init__(self, gl: moderngl.Context, textures: BufferTextureApi, count: int, components: int, dtype: str):
        row = np.dtype(dtype).itemsize * components
        self.bytes = row * driver_variants.rows(count, row)
        self.row, self.count = row, count
        self.buffer = gl.buffer(reserve=self.bytes)
        self._textures = textures
        self._texture = textures.create(self, self.buffer, FORMATS[dtype, components])

    def write(self, rows: np.ndarray, first: int = 0) -> None:
        """Write rows from the `first` one on."""
        if len(rows):
            self.buffer.write(np.ascontiguousarray(rows), offset=first * self.row)

    def use(self, location: int) -> None:
        """Put it into a texture unit."""
        self._textures.use(self._texture, location)

    def tell(self, program: moderngl.Program, name: str, unit: int) -> None:
        """Let a sampler of a program read from a texture unit with an array in it."""
        self._textures.tell(program, name, unit)


class GrowingBuffer:
    """An array to whose end rows are written: a larger one takes its place when it is full."""

    def __init__(self, gl: moderngl.Context, room: Callable[[int], BufferTexture], most: int):
        """`room` makes an array for so many rows, `most` is how many it may have."""
        self._gl, self._room, self._most = gl, room, most
        self.array, self.count = room(0), 0

    def reserve(self, more: int) -> None:
        """Make room for more rows: for just so many at first, then for some to come."""
        needed = self.count + more
        if needed > self.array.count:
            larger = self._room(max(needed, min(self.count + self.count // 2, self._most)))
            if self.count:
                self._gl.copy_buffer(larger.buffer, self.array.buffer, self.count * self.array.row)
            self.array = larger

    def append(self, rows: np.ndarray) -> None:
        """Write rows that there is room for."""
        self.array.write(rows, self.count)
        self.count += len(rows)
