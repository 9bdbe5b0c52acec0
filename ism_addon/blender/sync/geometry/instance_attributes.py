# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads attributes of objects, of their instancers and of the view layer, where Cycles looks for them."""

import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import bpy
import numpy as np

from .attributes import finite
from .geometry_instances import GeometryInstances


class InstanceAttribute(NamedTuple):
    """An attribute that is the same all over an instance."""

    type: str  # OBJECT, INSTANCER or VIEW_LAYER, as Blender names it
    name: str


#: Four numbers: those of an attribute that nothing has, and those in place of what an array lacks.
Numbers = tuple[float, float, float, float]
MISSING: Numbers = 0.0, 0.0, 0.0, 0.0
OPAQUE: Numbers = 0.0, 0.0, 0.0, 1.0

#: The end of a path to one number of an array, which Cycles does not follow.
INDEX = re.compile(r"\[-?\d+\]$")


class InstanceAttributeReader:
    """Reads attributes of instances. Geometries are read once, until `forget`."""

    def __init__(self) -> None:
        self._geometries = GeometryInstances()

    def forget(self) -> None:
        """To be called when the depsgraph has been read: it refers to its data."""
        self._geometries.forget()

    def read(
        self,
        attribute: InstanceAttribute,
        source: bpy.types.Object,
        view_layer: bpy.types.ViewLayer,
        instance: bpy.types.DepsgraphObjectInstance | None,
    ) -> Numbers:
        """The numbers of an attribute of an object, or of one of its instances."""
        type_, name = attribute
        if type_ == "VIEW_LAYER":
            scene = view_layer.id_data
            return first_property(name, view_layer, scene, scene.world)
        if type_ == "OBJECT" or instance is None:
            return first_property(name, source, source.data)
        particles = instance.particle_system
        found = None if particles is None else property_of(particles.settings, name)
        found = found or self._geometries.attribute(instance, name)
        return found or first_property(name, instance.parent, source, source.data)


def first_property(name: str, *owners: Any) -> Numbers:
    """The property of the first owner that has it."""
    found = (property_of(each, name) for each in owners if each is not None)
    return next((each for each in found if each is not None), MISSING)


def property_of(owner: Any, name: str) -> Numbers | None:
    """A custom property, or else what the RNA path leads to; None if that is no number, nor up to four of them."""
    if name in owner:
        return numbers_of(owner[name])
    try:
        return None if INDEX.search(name) else numbers_of(owner.path_resolve(name))
    except ValueError:
        return None


def numbers_of(value: Any) -> Numbers | None:
    """Single numbers are grey. None for other values than numbers, and for arrays of flags."""
    if isinstance(value, int | float):
        return value, value, value, 1.0
    size = len(value) if hasattr(value, "__len__") else 0
    if size not in range(1, 5) or not all(type(each) in (int, float) for each in value):
        return None
    return (*value, *OPAQUE[size:])


def attribute_table(
    rows: Sequence[Mapping[InstanceAttribute, Numbers]], indices: Mapping[InstanceAttribute, int]
) -> np.ndarray:
    """(P,A,4) float32 of what was read of instances: 0 where it was not. Without rows if there are no attributes."""
    table = np.zeros((len(rows) if indices else 0, len(indices), 4))
    for row, values in zip(table, rows, strict=False):
        for attribute, numbers in values.items():
            row[indices[attribute]] = numbers
    with np.errstate(over="ignore"):
        return finite(table.astype(np.float32))
