# SPDX-License-Identifier: GPL-3.0-or-later
"""Counts the calls of OpenGL's functions, whoever makes them: a counter of a few instructions before each of them.

Functions of OpenGL have many signatures, so Python cannot stand between: machine code that changes no argument can.
"""

import ctypes
import mmap
import platform
import struct
from collections import Counter

from tests.support.gl_wrapper import ContextWrapper, wrap_contexts

#: What changes nothing but a counter, and goes on to the function: both addresses are put in. By processor.
STUBS = {
    # mov r11, counter; inc qword [r11]; mov r11, function; jmp r11
    "x86_64": lambda counter, function: (
        b"\x49\xbb" + word(counter) + b"\x49\xff\x03\x49\xbb" + word(function) + b"\x41\xff\xe3"
    ),
    # ldr x16, counter; ldr x17, [x16]; add x17, x17, 1; str x17, [x16]; ldr x17, function; br x17
    "aarch64": lambda counter, function: (
        struct.pack("<6I", 0x580000D0, 0xF9400211, 0x91000631, 0xF9000211, 0x58000091, 0xD61F0220)
        + word(counter)
        + word(function)
    ),
}

#: Where stubs and counters lie: more than OpenGL has functions.
MAX_FUNCTIONS = 4096
STRIDE = 64

#: What waits for the GPU, or may do so.
WAITS = {"glFinish", "glClientWaitSync", "glReadPixels", "glGetTexImage", "glGetBufferSubData", "glMapBufferRange"}


def word(address: int) -> bytes:
    return struct.pack("<Q", address)


class CallCounter(ContextWrapper):
    """Of one context: it gives moderngl, and whoever asks, the counters in place of functions."""

    def __init__(self, context: object):
        super().__init__(context)
        self.stub = STUBS[platform.machine()]
        self.page = mmap.mmap(-1, MAX_FUNCTIONS * STRIDE, prot=mmap.PROT_READ | mmap.PROT_WRITE | mmap.PROT_EXEC)
        self.start = ctypes.addressof(ctypes.c_char.from_buffer(self.page))
        self.counters = (ctypes.c_uint64 * MAX_FUNCTIONS)()
        self.places: dict[str, int] = {}

    def load(self, name: str) -> int:
        """The address of a function of OpenGL's, or 0 where there is none."""
        function = self.context.load(name)
        if not function or not name.startswith("gl"):
            return function
        place = self.places.setdefault(name, len(self.places))
        stub = self.stub(ctypes.addressof(self.counters) + 8 * place, function)
        self.page[place * STRIDE : place * STRIDE + len(stub)] = stub
        return self.start + place * STRIDE

    @property
    def counts(self) -> Counter:
        """How often each function was called."""
        return Counter({name: self.counters[place] for name, place in self.places.items()})


def count_calls(monkeypatch) -> list[CallCounter]:
    """Lets all contexts that are opened from now on count: they are in the list."""
    return wrap_contexts(monkeypatch, CallCounter)


def objects_created(calls: Counter) -> int:
    """Textures, buffers, framebuffers, vertex arrays, queries and programs."""
    return sum(count for name, count in calls.items() if name.startswith(("glGen", "glCreate")))
