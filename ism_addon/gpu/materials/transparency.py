# SPDX-License-Identifier: GPL-3.0-or-later
"""What shaders of rays need to pass transparent surfaces. They read all tables from the scene's records."""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

from ..gl.shader_compiler import Include
from ..gl.shader_records import GRAPH_CONSTANT, IMAGE, INSTANCE, MATERIAL_TRANSPARENCY, OBJECT_INFO, Record

#: The columns of Transparency, in the order of Materials.transparency.
CAMERA, SHADOW = "x", "y"


@dataclass(frozen=True, eq=False)
class RayTransparency:
    """Parts of a shader of rays, and its uniforms; by default, of opaque surfaces."""

    constants: dict[str, Any] = field(default_factory=lambda: {"transparency": 0})
    parts: tuple[Record | Include, ...] = ()
    uniforms: dict[str, Any] = field(default_factory=dict)

    @property
    def records(self) -> tuple[Record, ...]:
        """The records among the parts."""
        return tuple(each for each in self.parts if isinstance(each, Record))

    @property
    def includes(self) -> tuple[Include, ...]:
        """The includes among the parts."""
        return tuple(each for each in self.parts if isinstance(each, Include))


OPAQUE = RayTransparency()


class SceneTransparency(NamedTuple):
    """That of a scene, for both types of rays."""

    camera: RayTransparency = OPAQUE
    shadow: RayTransparency = OPAQUE


ALL_OPAQUE = SceneTransparency()

#: Records that the shaders fetch.
RECORDS: tuple[Record, ...] = MATERIAL_TRANSPARENCY, GRAPH_CONSTANT, IMAGE, INSTANCE, OBJECT_INFO
