# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens an OpenGL context without a window, and waits for it.

The context belongs to the thread that opens it. That must not be Blender's main thread: there Blender's context would
stay current and receive our calls without an error.
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
from .buffer_texture import BufferTexture, BufferTextureApi, GrowingBuffer, SceneRecords
from .errors import ContextLost, GraphicsError, NoOpenGL
from .point_batch import PointBatch
from .timestamps import GpuClock

#: The OpenGL version that all passes need. macOS offers no newer one.
MIN_GL_VERSION = 410

#: EGL opens contexts without a window and without a display.
ON_EGL = sys.platform.startswith("linux")

SYNC_GPU_COMMANDS_COMPLETE = 0x9117
NO_TIMEOUT = (1 << 64) - 1  # ns


@dataclass(frozen=True)
class Device:
    """An open context, its limits, and functions that moderngl lacks."""

    gl: moderngl.Context
    texture_size: int
    name: str
    #: glFinish without the interpreter's lock (GIL): moderngl's finish() and read() hold it, which freezes Blender's
    #: window.
    wait: Callable[[], None]
    #: Flushes, then waits without the GIL for the previous submission: at most two are in flight. Software drivers
    #: queue no more of them, and would block within a draw, which holds the GIL.
    submit: Callable[[], None]
    #: Draws triangles of a vertex array: first triangle, count, instances. Without the GIL: software drivers process
    #: all vertices before the call returns.
    draw: Callable[[moderngl.VertexArray, int, int, int], None]
    #: Draws N ranges of triangles in one call: first triangles (N,) and counts (N,).
    draw_ranges: Callable[[moderngl.VertexArray, np.ndarray, np.ndarray], None]
    #: Until the state of OpenGL is set again, draws replace what their targets hold, without blending and depth test.
    overwrite: Callable[[], None]
    #: Whether the context is not lost.
    is_alive: Callable[[], bool]
    buffer_textures: BufferTextureApi
    #: Whether the depth buffer is reversed, see depth.py.
    reversed_depth: bool
    clock: GpuClock
    #: Draws points that change with each draw.
    points: PointBatch
    #: Compiled programs, or errors, by sources, records and constants, shared by all renderers.
    programs: dict[Hashable, moderngl.Program | Exception] = field(default_factory=dict)
    #: Called before a program is compiled, which can take a second.
    on_compile: list[Callable[[], None]] = field(default_factory=list)
    #: Resources that renderers share, as long as any uses them: see Frame.shared_resource.
    shared: "WeakValueDictionary[Hashable, Any]" = field(default_factory=WeakValueDictionary)

    def enable_only(self, flags: int) -> None:
        """moderngl's enable_only, after overwrite too."""
        self.gl.disable_direct(driver_variants.COLOR_LOGIC_OP)
        self.gl.enable_only(flags)

    def add(self) -> None:
        """Until the state of OpenGL is set again, draws add to what their targets hold."""
        self.enable_only(moderngl.BLEND)
        self.gl.blend_func = moderngl.ONE, moderngl.ONE

    def new_buffer(self, count: int, components: int, dtype: str) -> BufferTexture:
        """An empty buffer texture of `count` rows. Raises ValueError if these are too many."""
        limit = self.buffer_textures.max_rows
        if count > limit:
            raise ValueError(
                f"{count:,} rows are more than the {limit:,} that this OpenGL can fetch from; "
                "a scene of fewer triangles, instances and lights takes fewer"
            )
        return BufferTexture(self.gl, self.buffer_textures, count, components, dtype)

    def buffer_from(self, rows: np.ndarray) -> BufferTexture:
        """A buffer texture with the contents of rows (count,components)."""
        count, components = rows.shape
        buffer = self.new_buffer(count, components, rows.dtype.str[1:])
        buffer.write(rows)
        return buffer

    def growing_buffer(self, components: int, dtype: str) -> GrowingBuffer:
        """An empty buffer texture to which rows can be appended."""
        max_rows = self.buffer_textures.max_rows
        return GrowingBuffer(self.gl, lambda count: self.new_buffer(count, components, dtype), max_rows)

    def scene_records(self) -> SceneRecords:
        """The buffer of a renderer's tables, empty."""
        return SceneRecords(self.gl, lambda count: self.new_buffer(count, 4, "u4"))

    def check(self) -> None:
        """Raises ContextLost, or GraphicsError if any call since the last check has failed."""
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
        """Clear the cache of compiled programs."""
        self.programs.clear()
        self.points.forget()

    def free_released(self) -> None:
        """Delete OpenGL objects that Python has freed. In the thread that opened the context."""
        self.gl.gc()
        self.buffer_textures.free_released()

    def close(self) -> None:
        """Free the context with all its objects. In the thread that opened it."""
        if ON_EGL:
            # EGL keeps a context with all its textures while it is current in a thread, even in one that has ended.
            ctypes.CFUNCTYPE(ctypes.c_uint)(self.gl.mglo._context.load("eglReleaseThread"))()
        self.gl.release()


#: Ids of processes that have opened OpenGL. After a fork, the child's copy contains the parent's id.
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
    gl.gc_mode = "context_gc"  # free_released() deletes freed objects, in this thread
    gl.extra = BoundState(gl)
    driver_variants.use_all_samplers(gl)
    load = gl.mglo._context.load
    finish = ctypes.CFUNCTYPE(None)(load("glFinish"))
    limit, name = gl.info["GL_MAX_TEXTURE_SIZE"], gl.info["GL_RENDERER"]
    buffer_textures = BufferTextureApi(load, gl.info["GL_MAX_TEXTURE_BUFFER_SIZE"])
    submit, is_alive = two_in_flight(load), fence_alive(load)
    clock, points = GpuClock(load), PointBatch(gl, load)
    return Device(
        *(
            gl,
            limit,
            name,
            finish,
            submit,
            *draw_without_gil(load),
            driver_variants.overwriting(gl, name),
            is_alive,
            buffer_textures,
            depth.use_reversed_depth(gl),
            clock,
            points,
        )
    )


def two_in_flight(load: Callable[[str], int]) -> Callable[[], None]:
    """Device.submit. `load` gives the addresses of OpenGL's functions."""
    fence = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_uint, ctypes.c_uint)(load("glFenceSync"))
    wait = ctypes.CFUNCTYPE(ctypes.c_uint, ctypes.c_void_p, ctypes.c_uint, ctypes.c_uint64)(load("glClientWaitSync"))
    delete = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(load("glDeleteSync"))
    flush = ctypes.CFUNCTYPE(None)(load("glFlush"))
    in_flight: deque[int] = deque()

    def submit() -> None:
        in_flight.append(fence(SYNC_GPU_COMMANDS_COMPLETE, 0))
        flush()
        if len(in_flight) > 1:
            earlier = in_flight.popleft()
            wait(earlier, 0, NO_TIMEOUT)
            delete(earlier)

    return submit


def draw_without_gil(load: Callable[[str], int]) -> tuple[Callable[..., None], Callable[..., None]]:
    """Device.draw and Device.draw_ranges."""
    use_program = ctypes.CFUNCTYPE(None, ctypes.c_uint)(load("glUseProgram"))
    bind_vertex_array = ctypes.CFUNCTYPE(None, ctypes.c_uint)(load("glBindVertexArray"))
    draw_arrays = ctypes.CFUNCTYPE(None, ctypes.c_uint, *[ctypes.c_int] * 3)(load("glDrawArraysInstanced"))
    # moderngl does not offer glMultiDrawArrays, which OpenGL 4.1 has.
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
    """Device.is_alive. In a lost context, drivers ignore calls without an error, but create no fences."""
    fence = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_uint, ctypes.c_uint)(load("glFenceSync"))
    delete = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(load("glDeleteSync"))

    def is_alive() -> bool:
        sync = fence(SYNC_GPU_COMMANDS_COMPLETE, 0)
        delete(sync)  # ignores None
        return sync is not None

    return is_alive
