# SPDX-License-Identifier: GPL-3.0-or-later
"""Timestamps of the GPU (OpenGL 3.3 timer queries), read without waiting."""

import ctypes
from collections.abc import Callable

TIMESTAMP = 0x8E28
QUERY_COUNTER_BITS = 0x8864
QUERY_RESULT = 0x8866


class GpuClock:
    """The timer queries of one context."""

    def __init__(self, load: Callable[[str], int]):
        """`load` gives the addresses of OpenGL's functions."""
        name, names = ctypes.c_uint, ctypes.POINTER(ctypes.c_uint)
        self._generate = ctypes.CFUNCTYPE(None, ctypes.c_int, names)(load("glGenQueries"))
        self._query_counter = ctypes.CFUNCTYPE(None, name, name)(load("glQueryCounter"))
        times = ctypes.POINTER(ctypes.c_uint64)
        self._result = ctypes.CFUNCTYPE(None, name, name, times)(load("glGetQueryObjectui64v"))
        self._free: list[int] = []
        bits = ctypes.c_int()
        ctypes.CFUNCTYPE(None, name, name, ctypes.POINTER(ctypes.c_int))(load("glGetQueryiv"))(
            TIMESTAMP, QUERY_COUNTER_BITS, bits
        )
        #: Some drivers have no timer.
        self.is_available = bits.value > 0

    def record(self) -> int:
        """Record the time when the GPU has finished all commands so far. Returns a query, to be read once."""
        if not self._free:
            query_name = ctypes.c_uint()
            self._generate(1, query_name)
            self._free.append(query_name.value)
        query = self._free.pop()
        self._query_counter(query, TIMESTAMP)
        return query

    def read(self, query: int) -> float:
        """The recorded time, ms. Waits if the GPU has not recorded it yet."""
        time = ctypes.c_uint64()
        self._result(query, QUERY_RESULT, time)
        self._free.append(query)
        return time.value / 1e6
