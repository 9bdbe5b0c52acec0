# SPDX-License-Identifier: GPL-3.0-or-later
"""What time it is when the GPU has done what, without waiting for that: OpenGL 3.3's timestamps."""

import ctypes
from collections.abc import Callable

TIMESTAMP = 0x8E28
QUERY_COUNTER_BITS = 0x8864
QUERY_RESULT = 0x8866


class GpuClock:
    """Of one context."""

    def __init__(self, load: Callable[[str], int]):
        """`load` gives the addresses of OpenGL's functions."""
        name, names = ctypes.c_uint, ctypes.POINTER(ctypes.c_uint)
        self._generate = ctypes.CFUNCTYPE(None, ctypes.c_int, names)(load("glGenQueries"))
        self._note = ctypes.CFUNCTYPE(None, name, name)(load("glQueryCounter"))
        times = ctypes.POINTER(ctypes.c_uint64)
        self._result = ctypes.CFUNCTYPE(None, name, name, times)(load("glGetQueryObjectui64v"))
        self._free: list[int] = []
        bits = ctypes.c_int()
        ctypes.CFUNCTYPE(None, name, name, ctypes.POINTER(ctypes.c_int))(load("glGetQueryiv"))(
            TIMESTAMP, QUERY_COUNTER_BITS, bits
        )
        #: Some drivers have none that does.
        self.runs = bits.value > 0

    def note(self) -> int:
        """Let the GPU note the time when it has done all that it was asked for: the name to read it by, once."""
        if not self._free:
            made = ctypes.c_uint()
            self._generate(1, made)
            self._free.append(made.value)
        query = self._free.pop()
        self._note(query, TIMESTAMP)
        return query

    def read(self, query: int) -> float:
        """The time that was noted, ms; waits for it if the GPU has not come by yet."""
        time = ctypes.c_uint64()
        self._result(query, QUERY_RESULT, time)
        self._free.append(query)
        return time.value / 1e6
