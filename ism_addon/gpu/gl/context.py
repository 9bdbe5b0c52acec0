# SPDX-License-Identifier: GPL-3.0-or-later
"""Where an OpenGL context comes from, what it must be able to do, and how to wait for it.

The context belongs to the thread that opens it, which must not be Blender's main thread: there Blender's
own context would stay current and take our calls without a word.
"""

import ctypes
import os
import sys
from collections import deque
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import Any
from weakref import WeakValueDictionary

import moderngl
import numpy as np

from . import depth, driver_variants
from .bound_state import BoundState
from .buffer_texture import BufferTexture, BufferTextureApi, GrowingBuffer
from .errors import ContextLost, GraphicsError, NoOpenGL
from .point_batch import PointBatch
from .timestamps import GpuClock

#: OpenGL's version that every pass gets by with; macOS offers no newer one.
MIN_GL_VERSION = 410

#: Where contexts need no window, and no display either.
ON_EGL = sys.platform.startswith("linux")

SYNC_GPU_COMMANDS_COMPLETE = 0x9117
NO_TIMEOUT = (1 << 64) - 1  # ns


@dataclass(frozen=True)
class Device:
    """An open context, its limits, and its name."""

    gl: moderngl.Context
    texture_size: int
    name: str
    #: Returns when the GPU has done all that was asked of it, without holding the interpreter's lock:
    #: moderngl's own finish() and read() hold it while they wait, and Blender's window with it.
    wait: Callable[[], None]
    #: Lets the GPU begin with what was asked of it since the last time, and waits in the same way until it is done with
    #: what was asked before that: two portions are on their way at most. Software drivers have room for no more, and
    #: would wait for it in the middle of a draw.
    submit: Callable[[], None]
    #: Draws so many triangles by a vertex array, from a first one on, and each so many times. It does not hold the
    #: interpreter's lock either: software drivers are done with all vertices before they return.
    draw: Callable[[moderngl.VertexArray, int, int, int], None]
    #: Draws many such portions of triangles at once, (N,) first ones and (N,) how many, once each.
    draw_ranges: Callable[[moderngl.VertexArray, np.ndarray, np.ndarray], None]
    #: Whether the driver still has the context.
    is_alive: Callable[[], bool]
    buffer_textures: BufferTextureApi
    #: Whether depth is nearness, see depth.py.
    reversed_depth: bool
    clock: GpuClock
    #: For the points that passes draw once.
    points: PointBatch
    #: Compiled shaders by what they were made of: renderers share them.
    programs: dict[Hashable, moderngl.Program] = field(default_factory=dict)
    #: Called before a program is compiled, which takes some drivers a second.
    on_compile: list[Callable[[], None]] = field(default_factory=list)
    #: What was made of parts of scenes, as long as any renderer uses it: see Frame.shared.
    shared: "WeakValueDictionary[Hashable, Any]" = field(default_factory=WeakValueDictionary)

    def room(self, count: int, components: int, dtype: str) -> BufferTexture:
        """For rows that shaders fetch by number. Raises ValueError if they are more than it can have."""
        most = self.buffer_textures.most
        if count > most:
            raise ValueError(
                f"{count:,} rows are more than the {most:,} that this OpenGL can fetch from; "
                "a scene of fewer triangles, instances and lights takes fewer"
            )
        return BufferTexture(self.gl, self.buffer_textures, count, components, dtype)

    def array(self, rows: np.ndarray) -> BufferTexture:
        """The same with rows (count, components) in it."""
        count, components = rows.shape
        made = self.room(count, components, rows.dtype.str[1:])
        made.write(rows)
        return made

    def growing(self, components: int, dtype: str) -> GrowingBuffer:
        """The same for rows that come by and by."""
        return GrowingBuffer(self.gl, lambda count: self.room(count, components, dtype), self.buffer_textures.most)

    def check(self) -> None:
        """Whether all that was asked since the last time could be done. Raises ContextLost or GraphicsError."""
        if not self.is_alive():
            raise ContextLost(
                "The graphics driver has taken OpenGL away, as it does when it resets the card: render again"
            )
        error = self.gl.error
        if error == "GL_OUT_OF_MEMORY":
            raise GraphicsError(
                "the graphics memory is too small for it; a smaller picture or smaller images take less"
            )
        if error != "GL_NO_ERROR":
            raise GraphicsError(f"the graphics driver refuses it ({error})")

    def forget_programs(self) -> None:
        """Compile shaders again for those who ask from now on."""
        self.programs.clear()
        self.points.forget()

    def collect(self) -> None:
        """Free what was let go of. In the thread that opened it."""
        self.gl.gc()
        self.buffer_textures.collect()

    def close(self) -> None:
        """Free the context and all that is in it. In the thread that opened it."""
        if ON_EGL:
            # It keeps a context with all its textures as long as it is current in a thread, even in one that is gone.
            ctypes.CFUNCTYPE(ctypes.c_uint)(self.gl.mglo._context.load("eglReleaseThread"))()
        self.gl.release()


#: The processes that have opened OpenGL, of which this one may be a copy.
_openers: set[int] = set()


def open_device() -> Device:
    """Open a context without a window. Raises NoOpenGL."""
    if _openers - {os.getpid()}:
        raise NoOpenGL(
            "OpenGL does not outlive a fork, and the process that this one was forked from has opened it: "
            'start processes afresh, as multiprocessing does by "spawn"'
        )
    _openers.add(os.getpid())
    try:
        backend: dict[str, Any] = {"backend": "egl"} if ON_EGL else {}
        gl = moderngl.create_context(standalone=True, require=MIN_GL_VERSION, **backend)
    except Exception as reason:  # glcontext and moderngl raise bare Exceptions here
        raise NoOpenGL(
            f"OpenGL {MIN_GL_VERSION // 100}.{MIN_GL_VERSION // 10 % 10} could not be opened ({reason}): "
            "install the graphics card's driver, or Mesa's EGL libraries for rendering without a card"
        ) from reason
    gl.gc_mode = "context_gc"  # what is let go of is freed by collect(), in this thread
    gl.extra = BoundState(gl)
    driver_variants.use_all_samplers(gl)
    load = gl.mglo._context.load
    finish = ctypes.CFUNCTYPE(None)(load("glFinish"))
    limit, name = gl.info["GL_MAX_TEXTURE_SIZE"], gl.info["GL_RENDERER"]
    arrays = BufferTextureApi(load, gl.info["GL_MAX_TEXTURE_BUFFER_SIZE"])
    submit, is_alive = two_in_flight(load), fence_alive(load)
    clock, points = GpuClock(load), PointBatch(gl)
    return Device(
        *(
            gl,
            limit,
            name,
            finish,
            submit,
            *draw_without_gil(load),
            is_alive,
            arrays,
            depth.use_reversed_depth(gl),
            clock,
            points,
        )
    )


def two_in_flight(load: Callable[[str], int]) -> Callable[[], None]:
    """What Device.submit is; `load` gives the addresses of OpenGL's functions."""
    fence = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_uint, ctypes.c_uint)(load("glFenceSync"))
    wait = ctypes.CFUNCTYPE(ctypes.c_uint, ctypes.c_void_p, ctypes.c_uint, ctypes.c_uint64)(load("glClientWaitSync"))
    delete = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(load("glDeleteSync"))
    flush = ctypes.CFUNCTYPE(None)(load("glFlush"))
    under_way: deque[int] = deque()

    def submit() -> None:
        under_way.append(fence(SYNC_GPU_COMMANDS_COMPLETE, 0))
        flush()
        if len(under_way) > 1:
            earlier = under_way.popleft()
            wait(earlier, 0, NO_TIMEOUT)
            delete(earlier)

    return submit


def draw_without_gil(load: Callable[[str], int]) -> tuple[Callable[..., None], Callable[..., None]]:
    """What Device.draw and Device.draw_ranges are."""
    use_program = ctypes.CFUNCTYPE(None, ctypes.c_uint)(load("glUseProgram"))
    bind_vertex_array = ctypes.CFUNCTYPE(None, ctypes.c_uint)(load("glBindVertexArray"))
    draw_arrays = ctypes.CFUNCTYPE(None, ctypes.c_uint, *[ctypes.c_int] * 3)(load("glDrawArraysInstanced"))
    # moderngl has no such call that OpenGL 4.1 offers.
    ints = ctypes.POINTER(ctypes.c_int)
    draw_many = ctypes.CFUNCTYPE(None, ctypes.c_uint, ints, ints, ctypes.c_int)(load("glMultiDrawArrays"))

    def draw(vertex_array: moderngl.VertexArray, first: int, count: int, instances: int) -> None:
        use_program(vertex_array.program.glo)
        bind_vertex_array(vertex_array.glo)
        draw_arrays(moderngl.TRIANGLES, 3 * first, 3 * count, instances)

    def draw_ranges(vertex_array: moderngl.VertexArray, first: np.ndarray, count: np.ndarray) -> None:
        use_program(vertex_array.program.glo)
        bind_vertex_array(vertex_array.glo)
        firsts, counts = ((3 * each).astype(np.int32) for each in (first, count))
        draw_many(moderngl.TRIANGLES, firsts.ctypes.data_as(ints), counts.ctypes.data_as(ints), len(firsts))

    return draw, draw_ranges


def fence_alive(load: Callable[[str], int]) -> Callable[[], bool]:
    """What Device.is_alive is: without a context, drivers do nothing and say nothing, but they give no fences."""
    fence = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_uint, ctypes.c_uint)(load("glFenceSync"))
    delete = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(load("glDeleteSync"))

    def is_alive() -> bool:
        given = fence(SYNC_GPU_COMMANDS_COMPLETE, 0)
        delete(given)  # none is passed over
        return given is not None

    return is_alive
