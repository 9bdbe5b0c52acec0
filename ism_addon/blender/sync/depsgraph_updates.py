# SPDX-License-Identifier: GPL-3.0-or-later
"""What Blender says has changed since a depsgraph was last looked at, in the parts that are read one by one."""

from collections.abc import Collection
from typing import NamedTuple

import bpy

#: Objects that draw nothing themselves: what hangs on them is named on its own.
SILENT = {"EMPTY", "CAMERA", "ARMATURE", "LATTICE", "SPEAKER", "LIGHT_PROBE"}

#: What is read of these is read with the objects that have them, which are named too, or every time.
ELSEWHERE = (bpy.types.Mesh, bpy.types.Light, bpy.types.Camera, bpy.types.World, bpy.types.ShaderNodeTree)


class Updates(NamedTuple):
    """What is to be read again. Evaluated IDs, valid only during the call that was given the depsgraph."""

    whole: bool  # whether other things may stand in the scene now, or in other places
    objects: tuple[bpy.types.Object, ...]
    materials: tuple[bpy.types.Material, ...]
    images: bool
    shapes: frozenset[int]  # session_uid of the objects whose mesh, or what they instance, was made anew


def read(depsgraph: bpy.types.Depsgraph, instancers: Collection[int]) -> Updates:
    """All that the depsgraph names. What it names and we do not know means everything.

    `instancers` are the session_uids of the objects that made others stand when it was last looked at.
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
            whole |= changed.type not in {"MESH", "LIGHT", *SILENT}
        elif isinstance(changed, bpy.types.Material):
            materials.append(changed)
        elif isinstance(changed, bpy.types.Image):
            images = whole = True
        elif not isinstance(changed, ELSEWHERE):
            whole = True
    return Updates(whole, tuple(objects), tuple(materials), images, frozenset(shapes))


def _may_instance(update: bpy.types.DepsgraphUpdate) -> bool:
    """Whether the object makes others stand, or may have begun to: of those by geometry nodes Blender does not say."""
    by_nodes = update.is_updated_geometry and any(modifier.type == "NODES" for modifier in update.id.modifiers)
    return update.id.is_instancer or by_nodes
