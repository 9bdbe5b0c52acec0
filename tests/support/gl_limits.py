# SPDX-License-Identifier: GPL-3.0-or-later
"""An OpenGL that can no more than version 4.1 guarantees: it tells those limits, and keeps to them.

Between moderngl and the driver stand functions of Python, which glcontext gives in place of the driver's. Minimums are
from the tables of implementation dependent values, 6.40 to 6.54, in the specification of OpenGL 4.1.
"""

import ctypes
from collections.abc import Callable
from typing import Any

from tests.support.gl_wrapper import ContextWrapper

#: By the number of the question: its name, and the least that OpenGL 4.1 may answer.
MINIMUMS = {
    0x0D33: ("GL_MAX_TEXTURE_SIZE", 16384),
    0x8073: ("GL_MAX_3D_TEXTURE_SIZE", 2048),
    0x88FF: ("GL_MAX_ARRAY_TEXTURE_LAYERS", 2048),
    0x84E8: ("GL_MAX_RENDERBUFFER_SIZE", 16384),
    0x0D3A: ("GL_MAX_VIEWPORT_DIMS", 16384),
    0x8C2B: ("GL_MAX_TEXTURE_BUFFER_SIZE", 65536),
    0x8872: ("GL_MAX_TEXTURE_IMAGE_UNITS", 16),
    0x8B4C: ("GL_MAX_VERTEX_TEXTURE_IMAGE_UNITS", 16),
    0x8B4D: ("GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS", 80),
    0x8A30: ("GL_MAX_UNIFORM_BLOCK_SIZE", 16384),
    0x8B49: ("GL_MAX_FRAGMENT_UNIFORM_COMPONENTS", 1024),
    0x8B4A: ("GL_MAX_VERTEX_UNIFORM_COMPONENTS", 1024),
    0x8824: ("GL_MAX_DRAW_BUFFERS", 8),
    0x8CDF: ("GL_MAX_COLOR_ATTACHMENTS", 8),
    0x8869: ("GL_MAX_VERTEX_ATTRIBS", 16),
}
LIMITS = dict(MINIMUMS.values())

COPY_READ_BUFFER = 0x8F36
BUFFER_SIZE = 0x8764
TEXTURE0 = 0x84C0

_INT, _NAME, _INTS = ctypes.c_int, ctypes.c_uint, ctypes.POINTER(ctypes.c_int)
#: The functions that Python stands before: types of their arguments.
SIGNATURES = {
    "glGetIntegerv": (_NAME, _INTS),
    "glActiveTexture": (_NAME,),
    "glTexImage2D": (_NAME, _INT, _INT, _INT, _INT, _INT, _NAME, _NAME, ctypes.c_void_p),
    "glRenderbufferStorage": (_NAME, _NAME, _INT, _INT),
    "glDrawBuffers": (_INT, ctypes.c_void_p),
    "glTexBuffer": (_NAME, _NAME, _NAME),
}


class LimitedContext(ContextWrapper):
    """Of one context. What a driver with these limits would refuse is noted in `faults`."""

    def __init__(self, context: Any, bytes_of: dict[int, int]):
        """`bytes_of` has the bytes of a texel by the internal formats of buffer textures."""
        super().__init__(context)
        self.bytes_of = bytes_of
        self.faults: list[str] = []
        self._kept: list[object] = []  # a function of Python's must outlive its address

    def load(self, name: str) -> int:
        """The address of a function of OpenGL's, or 0 where there is none."""
        address = self.context.load(name)
        if not address or name not in SIGNATURES:
            return address
        kind = ctypes.CFUNCTYPE(None, *SIGNATURES[name])
        wrapper = kind(getattr(self, f"_{name}")(kind(address)))
        self._kept.append(wrapper)
        return ctypes.cast(wrapper, ctypes.c_void_p).value or 0

    def keep_below(self, what: str, count: int, name: str) -> None:
        if count > LIMITS[name]:
            self.faults.append(f"{what} {count} are more than {name}, {LIMITS[name]}")

    def _glGetIntegerv(self, ask: Callable[..., None]) -> Callable[..., None]:  # noqa: N802 (OpenGL's name)
        def answer(question: int, values: Any) -> None:
            ask(question, values)
            name, least = MINIMUMS.get(question, ("", 0))
            for k in range(0 if not name else 2 if name == "GL_MAX_VIEWPORT_DIMS" else 1):
                values[k] = min(values[k], least)

        return answer

    def _glActiveTexture(self, activate: Callable[..., None]) -> Callable[..., None]:  # noqa: N802
        def checked(unit: int) -> None:
            self.keep_below("texture units:", unit - TEXTURE0 + 1, "GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS")
            activate(unit)

        return checked

    def _glTexImage2D(self, make: Callable[..., None]) -> Callable[..., None]:  # noqa: N802
        def checked(*arguments: Any) -> None:
            self.keep_below("texels of a texture's side:", max(arguments[3:5]), "GL_MAX_TEXTURE_SIZE")
            make(*arguments)

        return checked

    def _glRenderbufferStorage(self, make: Callable[..., None]) -> Callable[..., None]:  # noqa: N802
        def checked(*arguments: Any) -> None:
            self.keep_below("pixels of a renderbuffer's side:", max(arguments[2:]), "GL_MAX_RENDERBUFFER_SIZE")
            make(*arguments)

        return checked

    def _glDrawBuffers(self, choose: Callable[..., None]) -> Callable[..., None]:  # noqa: N802
        def checked(count: int, buffers: Any) -> None:
            self.keep_below("targets at once:", count, "GL_MAX_DRAW_BUFFERS")
            choose(count, buffers)

        return checked

    def _glTexBuffer(self, _attach: Callable[..., None]) -> Callable[..., None]:  # noqa: N802
        """Rows beyond the limit are not there for shaders, as the specification has it."""
        load = self.context.load
        bind = ctypes.CFUNCTYPE(None, _NAME, _NAME)(load("glBindBuffer"))
        ask = ctypes.CFUNCTYPE(None, _NAME, _NAME, _INTS)(load("glGetBufferParameteriv"))
        attach = ctypes.CFUNCTYPE(None, _NAME, _NAME, _NAME, ctypes.c_ssize_t, ctypes.c_ssize_t)(
            load("glTexBufferRange")
        )

        def attach_part(target: int, format: int, buffer: int) -> None:
            size = ctypes.c_int()
            bind(COPY_READ_BUFFER, buffer)
            ask(COPY_READ_BUFFER, BUFFER_SIZE, size)
            bind(COPY_READ_BUFFER, 0)
            most = LIMITS["GL_MAX_TEXTURE_BUFFER_SIZE"] * self.bytes_of[format]
            attach(target, format, buffer, 0, min(size.value, most))

        return attach_part
