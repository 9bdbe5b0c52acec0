# SPDX-License-Identifier: GPL-3.0-or-later
"""Graphs that shaders evaluate where rays meet surfaces. They read all tables from the scene's records."""

from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from ..gl.shader_compiler import Include
from ..gl.shader_records import (
    GRAPH_CONSTANT,
    IMAGE,
    INSTANCE,
    MATERIAL_EMISSION,
    MATERIAL_TRANSPARENCY,
    OBJECT_INFO,
    Record,
)


@dataclass(frozen=True, eq=False)
class PointGraphs:
    """Parts of a shader that evaluates graphs, and its uniforms."""

    constants: dict[str, Any]
    parts: tuple[Record | Include, ...] = ()
    uniforms: dict[str, Any] = field(default_factory=dict)

    def with_uniforms(self, uniforms: dict[str, Any]) -> "PointGraphs":
        """The same with further uniforms."""
        return replace(self, uniforms=self.uniforms | uniforms)

    @property
    def records(self) -> tuple[Record, ...]:
        """The records among the parts."""
        return tuple(each for each in self.parts if isinstance(each, Record))

    @property
    def includes(self) -> tuple[Include, ...]:
        """The includes among the parts."""
        return tuple(each for each in self.parts if isinstance(each, Include))


#: Of shaders that meet opaque surfaces alone, and of those that see surfaces of even emission alone.
OPAQUE = PointGraphs({"transparency": 0})
EVEN = PointGraphs({"emission_graphs": 0})


class ScenePointGraphs(NamedTuple):
    """What passes through a scene's surfaces, for camera rays and for shadow rays, and what the camera sees emitted."""

    camera: PointGraphs = OPAQUE
    shadow: PointGraphs = OPAQUE
    emission: PointGraphs = EVEN
    points: PointGraphs = OPAQUE  # as `shadow`, for points that no ray has found


NO_POINT_GRAPHS = ScenePointGraphs()

#: Records that the shaders fetch.
RECORDS: tuple[Record, ...] = (
    *(MATERIAL_TRANSPARENCY, MATERIAL_EMISSION, GRAPH_CONSTANT),
    *(IMAGE, INSTANCE, OBJECT_INFO),
)
