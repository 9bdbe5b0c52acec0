# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws points that change with each draw: one buffer, refilled each time, and a vertex array for each program."""

import ctypes
from collections.abc import Callable

import moderngl
import numpy as np


class PointBatch:
    """The buffer and vertex arrays of one context."""

    def __init__(self, gl: moderngl.Context, load: Callable[[str], int]):
        """`load` gives the addresses of OpenGL's functions."""
        self._gl = gl
        # Without the GIL, unlike moderngl's: software drivers compile a program for up to a second when it first draws.
        self._use_program = ctypes.CFUNCTYPE(None, ctypes.c_uint)(load("glUseProgram"))
        self._bind_vertex_array = ctypes.CFUNCTYPE(None, ctypes.c_uint)(load("glBindVertexArray"))
        self._draw_arrays = ctypes.CFUNCTYPE(None, ctypes.c_uint, *[ctypes.c_int] * 3)(load("glDrawArraysInstanced"))
        self._buffer = gl.buffer(reserve=1, dynamic=True)
        self._vertex_arrays: dict[moderngl.Program, moderngl.VertexArray] = {}

    def draw(self, program: moderngl.Program, rows: np.ndarray, layout: tuple[str, ...]) -> None:
        """Draw a point for each row. `layout`: moderngl's format and attribute names; a program may lack attributes."""
        if program not in self._vertex_arrays:
            content = [(self._buffer, *layout)]
            self._vertex_arrays[program] = self._gl.vertex_array(program, content, skip_errors=True)
        self._buffer.orphan(rows.nbytes)  # the driver may still read the old contents
        self._buffer.write(rows)
        self._use_program(program.glo)
        self._bind_vertex_array(self._vertex_arrays[program].glo)
        self._draw_arrays(moderngl.POINTS, 0, len(rows), 1)

    def forget(self) -> None:
        """Release the programs."""
        self._vertex_arrays.clear()
