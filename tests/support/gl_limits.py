# SPDX-License-Identifier: GPL-3.0-or-later
"""An OpenGL context with no higher limits than version 4.1 guarantees: it reports them and checks calls against them.

Python functions wrap those of the driver, and moderngl gets their addresses from glcontext. Minimums are from the
tables of implementation dependent values, 6.40 to 6.54, in the specification of OpenGL 4.1.
"""

import ctypes
from collections.abc import Callable
from typing import Any

from tests.support.gl_wrapper import ContextWrapper

#: By the value of a limit's enum: its name, and the minimum that OpenGL 4.1 allows.
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
#: The wrapped functions: types of their arguments.
SIGNATURES = {
    "glGetIntegerv": (_NAME, _INTS),
    "glActiveTexture": (_NAME,),
    "glTexImage2D": (_NAME, _INT, _INT, _INT, _INT, _INT, _NAME, _NAME, ctypes.c_void_p),
    "glRenderbufferStorage": (_NAME, _NAME, _INT, _INT),
    "glDrawBuffers": (_INT, ctypes.c_void_p),
    "glTexBuffer": (_NAME, _NAME, _NAME),
}


class LimitedContext(ContextWrapper):
    """Wraps one context. Calls that a driver with these limits would refuse are noted in `faults`."""

    def __init__(self, context: Any, texel_bytes: dict[int, int]):
        """`texel_bytes`: bytes of a texel, by the internal format of a buffer texture."""
        super().__init__(context)
        self.texel_bytes = texel_bytes
        self.faults: list[str] = []
        self._kept: list[object] = []  # a Python function must outlive its address

    def load(self, name: str) -> int:
        """The address of an OpenGL function or its wrapper, or 0 if there is no such function."""
        address = self.context.load(name)
        if not address or name not in SIGNATURES:
            return address
        function_type = ctypes.CFUNCTYPE(None, *SIGNATURES[name])
        wrapper = function_type(getattr(self, f"_{name}")(function_type(address)))
        self._kept.append(wrapper)
        return ctypes.cast(wrapper, ctypes.c_void_p).value or 0

    def check(self, what: str, count: int, name: str) -> None:
        """Note a fault if a count is above the limit of that name."""
        if count > LIMITS[name]:
            self.faults.append(f"{what} {count} are more than {name}, {LIMITS[name]}")

    def _glGetIntegerv(self, get: Callable[..., None]) -> Callable[..., None]:  # noqa: N802 (OpenGL's name)
        def limited(parameter: int, values: Any) -> None:
            get(parameter, values)
            name, minimum = MINIMUMS.get(parameter, ("", 0))
            for k in range(0 if not name else 2 if name == "GL_MAX_VIEWPORT_DIMS" else 1):
                values[k] = min(values[k], minimum)

        return limited

    def _glActiveTexture(self, activate: Callable[..., None]) -> Callable[..., None]:  # noqa: N802
        def checked(unit: int) -> None:
            self.check("texture units:", unit - TEXTURE0 + 1, "GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS")
            activate(unit)

        return checked

    def _glTexImage2D(self, make: Callable[..., None]) -> Callable[..., None]:  # noqa: N802
        def checked(*arguments: Any) -> None:
            self.check("texels of a texture's side:", max(arguments[3:5]), "GL_MAX_TEXTURE_SIZE")
            make(*arguments)

        return checked

    def _glRenderbufferStorage(self, make: Callable[..., None]) -> Callable[..., None]:  # noqa: N802
        def checked(*arguments: Any) -> None:
            self.check("pixels of a renderbuffer's side:", max(arguments[2:]), "GL_MAX_RENDERBUFFER_SIZE")
            make(*arguments)

        return checked

    def _glDrawBuffers(self, choose: Callable[..., None]) -> Callable[..., None]:  # noqa: N802
        def checked(count: int, buffers: Any) -> None:
            self.check("targets at once:", count, "GL_MAX_DRAW_BUFFERS")
            choose(count, buffers)

        return checked

    def _glTexBuffer(self, _attach: Callable[..., None]) -> Callable[..., None]:  # noqa: N802
        """Shaders cannot fetch texels beyond the limit, as the specification says."""
        load = self.context.load
        bind = ctypes.CFUNCTYPE(None, _NAME, _NAME)(load("glBindBuffer"))
        get_parameter = ctypes.CFUNCTYPE(None, _NAME, _NAME, _INTS)(load("glGetBufferParameteriv"))
        attach = ctypes.CFUNCTYPE(None, _NAME, _NAME, _NAME, ctypes.c_ssize_t, ctypes.c_ssize_t)(
            load("glTexBufferRange")
        )

        def attach_limited(target: int, format: int, buffer: int) -> None:
            size = ctypes.c_int()
            bind(COPY_READ_BUFFER, buffer)
            get_parameter(COPY_READ_BUFFER, BUFFER_SIZE, size)
            bind(COPY_READ_BUFFER, 0)
            max_size = LIMITS["GL_MAX_TEXTURE_BUFFER_SIZE"] * self.texel_bytes[format]
            attach(target, format, buffer, 0, min(size.value, max_size))

        return attach_limited
