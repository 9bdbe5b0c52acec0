# SPDX-License-Identifier: GPL-3.0-or-later
"""Counts the calls of OpenGL functions by any caller: a stub of a few instructions increments a counter before each.

The functions have many signatures, so they are wrapped in machine code that changes no argument, not in Python.
"""

import ctypes
import mmap
import platform
import struct
from collections import Counter

from tests.support.gl_wrapper import ContextWrapper, wrap_contexts

#: By processor, machine code that increments a counter and jumps to a function. Both addresses are inserted.
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

#: Number of stubs and counters: more than OpenGL has functions.
MAX_FUNCTIONS = 4096
#: Bytes from one stub to the next.
STRIDE = 64

#: Functions that wait for the GPU, or may do so.
WAITS = {"glFinish", "glClientWaitSync", "glReadPixels", "glGetTexImage", "glGetBufferSubData", "glMapBufferRange"}


def word(address: int) -> bytes:
    return struct.pack("<Q", address)


class CallCounter(ContextWrapper):
    """Wraps one context: moderngl, and any other caller, gets the addresses of counting stubs."""

    def __init__(self, context: object):
        super().__init__(context)
        self.stub = STUBS[platform.machine()]
        self.page = mmap.mmap(-1, MAX_FUNCTIONS * STRIDE, prot=mmap.PROT_READ | mmap.PROT_WRITE | mmap.PROT_EXEC)
        self.start = ctypes.addressof(ctypes.c_char.from_buffer(self.page))
        self.counters = (ctypes.c_uint64 * MAX_FUNCTIONS)()
        self.indices: dict[str, int] = {}

    def load(self, name: str) -> int:
        """The address of an OpenGL function's stub, or 0 if there is no such function."""
        function = self.context.load(name)
        if not function or not name.startswith("gl"):
            return function
        index = self.indices.setdefault(name, len(self.indices))
        stub = self.stub(ctypes.addressof(self.counters) + 8 * index, function)
        self.page[index * STRIDE : index * STRIDE + len(stub)] = stub
        return self.start + index * STRIDE

    @property
    def counts(self) -> Counter:
        """Calls of each function so far."""
        return Counter({name: self.counters[index] for name, index in self.indices.items()})


def count_calls(monkeypatch) -> list[CallCounter]:
    """Wrap all contexts that are opened from now on: their wrappers are added to the list."""
    return wrap_contexts(monkeypatch, CallCounter)


def objects_created(calls: Counter) -> int:
    """Number of textures, buffers, framebuffers, vertex arrays, queries and programs created by calls."""
    return sum(count for name, count in calls.items() if name.startswith(("glGen", "glCreate")))
