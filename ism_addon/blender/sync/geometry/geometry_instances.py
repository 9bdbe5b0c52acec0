# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes of instances that geometry nodes make, on each level of nested instances.

Blender identifies an instance by a number on each level, from the innermost to the outermost: its position or its
attribute `id`. Each level is the geometry of an object or of an instance, a collection, or an object.
"""

from typing import Any

import bpy
import numpy as np

from ..diagnostics import Diagnostics
from . import attributes, triangulate

#: The number of levels that there are not.
UNUSED = 2**31 - 1
#: The innermost levels, of which Blender keeps attributes.
MAX_LEVELS = 4

#: What a geometry has besides instances, and the objects that have it themselves, not as an instance of their own.
COMPONENTS = {
    "mesh": {"MESH"},
    "volume": {"VOLUME"},
    "curves": {"CURVE", "FONT", "CURVES"},
    "pointcloud": {"POINTCLOUD"},
    "grease_pencil": {"GREASEPENCIL"},
}

#: Types of attributes that Blender converts to colors.
COLORS = attributes.PROPERTIES.keys() - {"QUATERNION"}

#: Before Blender 4.5, Python cannot read instances.
IS_KNOWN = hasattr(bpy.types.Object, "evaluated_geometry")


class _Geometry:
    """The instances of a geometry set."""

    def __init__(self, geometry: Any, object_type: str = ""):
        """`object_type`: of the object whose geometry it is; "" for that of an instance."""
        self._geometry, points = geometry, geometry.instances_pointcloud()  # which is freed with the geometry
        self._attributes = {} if points is None else points.attributes
        self._values: dict[str, np.ndarray | None] = {}
        self._count = 0 if points is None else len(points.points)
        self._rows: dict[int, int] | None = None
        self._references: list[Any] = []
        #: Whether it has anything that is drawn as an instance of its own.
        self.has_components = any(
            getattr(geometry, name) is not None for name, types in COMPONENTS.items() if object_type not in types
        )
        if self._count:
            self._references = geometry.instance_references()
            self._indices = triangulate.read(self._attributes[".reference_index"].data, "value", self._count, np.int32)

    def row(self, number: int) -> int | None:
        """The instance of a number; None if there is none.

        Where several have the same `id`, Blender gives numbers to all but the first at random: they are in order.
        """
        if self._rows is None:
            numbers = np.arange(self._count)
            if "id" in self._attributes:
                numbers = triangulate.read(self._attributes["id"].data, "value", self._count, np.int32)
            unique, first = np.unique(numbers, return_index=True)
            self._rows = dict(zip(unique.tolist(), first.tolist(), strict=True))
            self._others = iter(np.setdiff1d(np.arange(self._count), first).tolist())
        if number not in self._rows and (other := next(self._others, None)) is not None:
            self._rows[number] = other
        return self._rows.get(number)

    def reference(self, row: int) -> Any:
        """What an instance is one of: an object, a collection or a _Geometry; or None."""
        index = int(self._indices[row])
        found = self._references[index]
        if hasattr(found, "instances_pointcloud"):
            found = self._references[index] = _Geometry(found)
        return found

    def values(self, name: str) -> np.ndarray | None:
        """(N,4) float32: an attribute of the instances; None if they have none that is a color."""
        if name not in self._values:
            stored = self._attributes.get(name)
            is_color = stored is not None and stored.data_type in COLORS
            self._values[name] = attributes.four_numbers(stored) if is_color else None
        return self._values[name]


class GeometryInstances:
    """Finds instances in the geometries of objects. These are read once, until `forget`."""

    def __init__(self) -> None:
        self._geometries: dict[int, _Geometry] = {}

    def forget(self) -> None:
        """To be called when the depsgraph has been read: it refers to its data."""
        self._geometries.clear()

    def attribute(
        self, instance: bpy.types.DepsgraphObjectInstance, name: str
    ) -> tuple[float, float, float, float] | None:
        """Four numbers of the innermost level that has the attribute; None if none has."""
        for geometry, row in self._levels(instance):
            values = geometry.values(name)
            if values is not None:
                x, y, z, w = values[row].tolist()
                return x, y, z, w
        return None

    def _levels(self, instance: bpy.types.DepsgraphObjectInstance) -> list[tuple[_Geometry, int]]:
        """The geometries that an instance is in, with its rows, from the innermost to the outermost."""
        numbers = [number for number in instance.persistent_id if number != UNUSED]
        owner: Any = instance.parent
        found: list[tuple[_Geometry, int]] = []
        while IS_KNOWN and numbers and owner is not None:
            number = numbers.pop()
            if isinstance(owner, bpy.types.Object):
                if owner.type == "EMPTY":  # that instances a collection
                    objects = owner.instance_collection.all_objects if owner.instance_collection else ()
                    owner = objects[number] if number < len(objects) else None
                    continue
                owner = self._geometry_of(owner)
            if owner.has_components:
                if not numbers:
                    break  # the instance is one of them
                number = numbers.pop()
            row = owner.row(number)
            if row is None:
                break
            found.append((owner, row))
            reference = owner.reference(row)
            owner = None if isinstance(reference, bpy.types.Collection) else reference
        return found[::-1][:MAX_LEVELS]

    def _geometry_of(self, source: bpy.types.Object) -> _Geometry:
        key = source.as_pointer()
        if key not in self._geometries:
            self._geometries[key] = _Geometry(source.evaluated_geometry(), source.type)
        return self._geometries[key]


def warn_of_unknown(instancer: bpy.types.Object, findings: Diagnostics) -> None:
    """Warn of attributes of instances that this release of Blender does not tell."""
    if not IS_KNOWN and any(modifier.type == "NODES" for modifier in instancer.modifiers):
        issue = "Attributes of instances that geometry nodes make are not known before Blender 4.5"
        findings.warn(issue, instancer.name)
