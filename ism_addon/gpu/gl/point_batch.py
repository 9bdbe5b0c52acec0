# SPDX-License-Identifier: GPL-3.0-or-later
"""Points that are drawn once: a buffer that is filled again and again, and for each program a vertex array over it."""

import moderngl
import numpy as np


class PointBatch:
    """Of one context."""

    def __init__(self, gl: moderngl.Context):
        self._gl = gl
        self._buffer = gl.buffer(reserve=1, dynamic=True)
        self._vertex_arrays: dict[moderngl.Program, moderngl.VertexArray] = {}

    def draw(self, program: moderngl.Program, rows: np.ndarray, layout: tuple[str, ...]) -> None:
        """A point a row, laid out as moderngl is told: formats, and names of inputs. Programs need not have all."""
        if program not in self._vertex_arrays:
            content = [(self._buffer, *layout)]
            self._vertex_arrays[program] = self._gl.vertex_array(program, content, skip_errors=True)
        self._buffer.orphan(rows.nbytes)  # drivers may still be drawing what it had
        self._buffer.write(rows)
        self._vertex_arrays[program].render(moderngl.POINTS, vertices=len(rows))

    def forget(self) -> None:
        """Let go of the programs."""
        self._vertex_arrays.clear()
