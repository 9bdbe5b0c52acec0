# SPDX-License-Identifier: GPL-3.0-or-later
"""Sorts a depsgraph's updates into what has to be read again."""

from collections.abc import Collection
from typing import NamedTuple

import bpy

#: Objects that are not drawn. Objects that depend on them have updates of their own.
NOT_DRAWN = {"EMPTY", "CAMERA", "ARMATURE", "LATTICE", "SPEAKER", "LIGHT_PROBE"}

#: Data that is read with its objects, which are updated too, or that is always read.
READ_WITH_OBJECTS = (bpy.types.Mesh, bpy.types.Light, bpy.types.Camera, bpy.types.ShaderNodeTree)


class Updates(NamedTuple):
    """What has to be read again. Evaluated IDs, valid only during the call that got the depsgraph."""

    all_instances: bool  # there may be other instances, or instances in other positions
    objects: tuple[bpy.types.Object, ...]
    materials: tuple[bpy.types.Material, ...]
    images: bool
    world: bool
    changed_geometry: frozenset[int]  # session_uids of objects with changed geometry, also in their instances


def read(depsgraph: bpy.types.Depsgraph, instanced: Collection[int]) -> Updates:
    """The updates of a depsgraph. After an update of an unknown type, all instances are read.

    `instanced`: session_uids of the objects that made instances, or had any, when the depsgraph was last read.
    """
    all_instances = images = world = False
    objects, materials, changed_geometry = [], [], set()
    for update in depsgraph.updates:
        changed = update.id
        if isinstance(changed, bpy.types.Object):
            objects.append(changed)
            if update.is_updated_geometry:
                changed_geometry.add(changed.original.session_uid)
            all_instances |= changed.original.session_uid in instanced or _may_instance(update)
            all_instances |= changed.type not in {"MESH", "LIGHT", *NOT_DRAWN}
        elif isinstance(changed, bpy.types.Material):
            materials.append(changed)
        elif isinstance(changed, bpy.types.Image):
            images = all_instances = True
        elif isinstance(changed, bpy.types.World):
            world = True
        elif not isinstance(changed, READ_WITH_OBJECTS):
            all_instances = True
    return Updates(all_instances, tuple(objects), tuple(materials), images, world, frozenset(changed_geometry))


def _may_instance(update: bpy.types.DepsgraphUpdate) -> bool:
    """Whether the object has, or may have, instances: Blender does not report new ones of geometry nodes."""
    by_nodes = update.is_updated_geometry and any(modifier.type == "NODES" for modifier in update.id.modifiers)
    return update.id.is_instancer or by_nodes
