# SPDX-License-Identifier: GPL-3.0-or-later
"""What a context holds already: textures in texture units, and values in the uniforms of programs.

So nothing is set that is set. Each sampler's name has a texture unit of its own, the same one in all programs.
"""

import weakref
from typing import Any, Protocol

import moderngl
import numpy as np

#: Where moderngl puts textures that it makes, reads or writes.
MODERNGL_UNIT = 0


class Texture(Protocol):
    """moderngl's, or an Array."""

    def use(self, location: int) -> None:
        """Put it into a texture unit."""


class BoundState:
    """Of one context, whose `extra` it is."""

    def __init__(self, gl: moderngl.Context):
        gl.default_texture_unit = MODERNGL_UNIT
        self._units: dict[str, int] = {}
        #: By unit. OpenGL takes a texture out of its units as it is deleted: that is when nobody has it any more.
        self._textures: dict[int, weakref.ref[Texture]] = {}
        self._values: weakref.WeakKeyDictionary[moderngl.Program, dict[str, bytes]] = weakref.WeakKeyDictionary()

    def unit_with(self, name: str, texture: Texture) -> int:
        """The texture unit of the samplers of this name, with a texture in it."""
        unit = self._units.setdefault(name, len(self._units) + MODERNGL_UNIT + 1)
        there = self._textures.get(unit)
        if there is None or there() is not texture:
            texture.use(unit)
            self._textures[unit] = weakref.ref(texture)
        return unit

    def is_new(self, program: moderngl.Program, name: str, value: Any) -> bool:
        """Whether a uniform has to be set to have this value, which it has from now on."""
        values = self._values.setdefault(program, {})
        content = np.asarray(value).tobytes()
        if values.get(name) == content:
            return False
        values[name] = content
        return True
