# SPDX-License-Identifier: GPL-3.0-or-later
"""Cached OpenGL state: the textures bound to texture units, and the values of uniforms.

State that is already set is not set again. Each sampler name has its own texture unit, the same in all programs.
"""

import weakref
from typing import Any, Protocol

import moderngl
import numpy as np

#: The texture unit that moderngl binds textures to when it creates, reads or writes them.
MODERNGL_UNIT = 0


class Texture(Protocol):
    """moderngl's textures, or a BufferTexture."""

    def use(self, location: int) -> None:
        """Bind it to a texture unit."""


class BoundState:
    """The cache of one context, stored as its `extra`."""

    def __init__(self, gl: moderngl.Context):
        gl.default_texture_unit = MODERNGL_UNIT
        self._units: dict[str, int] = {}
        #: By unit. Weak, because OpenGL unbinds a texture when it is deleted.
        self._textures: dict[int, weakref.ref[Texture]] = {}
        self._values: weakref.WeakKeyDictionary[moderngl.Program, dict[str, object]] = weakref.WeakKeyDictionary()

    def unit_with(self, name: str, texture: Texture) -> int:
        """The texture unit of samplers with this name, after the texture is bound to it."""
        unit = self._units.setdefault(name, len(self._units) + MODERNGL_UNIT + 1)
        bound = self._textures.get(unit)
        if bound is None or bound() is not texture:
            texture.use(unit)
            self._textures[unit] = weakref.ref(texture)
        return unit

    def values(self, program: moderngl.Program) -> dict[str, object]:
        """The values of a program's uniforms by name, for is_new."""
        return self._values.setdefault(program, {})


def is_new(values: dict[str, object], name: str, value: Any) -> bool:
    """Whether a uniform's value differs from this one, which is then stored in `values`."""
    content = value if isinstance(value, (int, float, tuple)) else np.asarray(value).tobytes()
    if values.get(name) == content:
        return False
    values[name] = content
    return True
