# SPDX-License-Identifier: GPL-3.0-or-later
"""Sorts a depsgraph's updates into what has to be read again."""

from collections.abc import Collection
from typing import NamedTuple

import bpy

#: Objects that are not drawn. Objects that depend on them have updates of their own.
NOT_DRAWN = {"EMPTY", "CAMERA", "ARMATURE", "LATTICE", "SPEAKER", "LIGHT_PROBE"}

#: Data that is read with its objects, which have updates too, or every time.
READ_WITH_OBJECTS = (bpy.types.Mesh, bpy.types.Light, bpy.types.Camera, bpy.types.World, bpy.types.ShaderNodeTree)


class Updates(NamedTuple):
    """What is to be read again. Evaluated IDs, valid only during the call that got the depsgraph."""

    whole: bool  # all instances: there may be others, or in other positions
    objects: tuple[bpy.types.Object, ...]
    materials: tuple[bpy.types.Material, ...]
    images: bool
    shapes: frozenset[int]  # session_uid of the objects whose geometry, or that of their instances, has changed


def read(depsgraph: bpy.types.Depsgraph, instancers: Collection[int]) -> Updates:
    """The updates of a depsgraph. An update of an unknown type means all.

    `instancers`: session_uids of the objects that had instances when it was last read.
    """
    whole = images = False
    objects, materials, shapes = [], [], set()
    for update in depsgraph.updates:
        changed = update.id
        if isinstance(changed, bpy.types.Object):
            objects.append(changed)
            if update.is_updated_geometry:
                shapes.add(changed.original.session_uid)
            whole |= changed.original.session_uid in instancers or _may_instance(update)
            whole |= changed.type not in {"MESH", "LIGHT", *NOT_DRAWN}
        elif isinstance(changed, bpy.types.Material):
            materials.append(changed)
        elif isinstance(changed, bpy.types.Image):
            images = whole = True
        elif not isinstance(changed, READ_WITH_OBJECTS):
            whole = True
    return Updates(whole, tuple(objects), tuple(materials), images, frozenset(shapes))


def _may_instance(update: bpy.types.DepsgraphUpdate) -> bool:
    """Whether the object has instances, or may have: Blender does not report new ones of geometry nodes."""
    by_nodes = update.is_updated_geometry and any(modifier.type == "NODES" for modifier in update.id.modifiers)
    return update.id.is_instancer or by_nodes
