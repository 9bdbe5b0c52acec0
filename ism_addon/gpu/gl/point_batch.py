# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws points that change with each draw: one buffer, refilled each time, and a vertex array for each program."""

import moderngl
import numpy as np


class PointBatch:
    """The buffer and vertex arrays of one context."""

    def __init__(self, gl: moderngl.Context):
        self._gl = gl
        self._buffer = gl.buffer(reserve=1, dynamic=True)
        self._vertex_arrays: dict[moderngl.Program, moderngl.VertexArray] = {}

    def draw(self, program: moderngl.Program, rows: np.ndarray, layout: tuple[str, ...]) -> None:
        """Draw a point for each row. `layout`: moderngl's format and attribute names; a program may lack attributes."""
        if program not in self._vertex_arrays:
            content = [(self._buffer, *layout)]
            self._vertex_arrays[program] = self._gl.vertex_array(program, content, skip_errors=True)
        self._buffer.orphan(rows.nbytes)  # the driver may still read the old contents
        self._buffer.write(rows)
        self._vertex_arrays[program].render(moderngl.POINTS, vertices=len(rows))

    def forget(self) -> None:
        """Release the programs."""
        self._vertex_arrays.clear()
