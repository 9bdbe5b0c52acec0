# SPDX-License-Identifier: GPL-3.0-or-later
"""An evaluated depsgraph to one Scene: all that renders, copied, so nothing of bpy outlives the call.

Blender presents curves, texts, metaballs and surfaces as instances of the meshes that they evaluate to,
beside the object itself: only meshes need be read.
"""

from collections.abc import Callable

import bpy

from ...scene import Scene
from . import depsgraph_updates, missing_libraries, unsupported_scene, world
from .diagnostics import Diagnostics
from .geometry.instances import InstanceReader
from .light_linking import LightLinks
from .lights import LightReader
from .materials import images
from .materials.materials import MaterialReader

#: Objects that render in other engines, and not in this one.
UNDRAWN = {
    "CURVES": "Hair curves",
    "POINTCLOUD": "Point clouds",
    "VOLUME": "Volumes",
    "GREASEPENCIL": "Grease pencil drawings",
    "GPENCIL": "Grease pencil drawings",
}


def everywhere(_object: bpy.types.Object) -> bool:
    """What a final render shows of what the depsgraph does: all."""
    return True


def scene(depsgraph: bpy.types.Depsgraph, shown: Callable[[bpy.types.Object], bool] = everywhere) -> Scene:
    """Everything that the depsgraph shows and is wanted, with a sentence for each kind of thing that was left out."""
    return Reader().read(depsgraph, shown)


class Reader:
    """Reads a depsgraph once, and then what changes: whatever did not is the same object as in the last Scene."""

    def __init__(self) -> None:
        self._materials = MaterialReader()
        links = LightLinks()
        self._geometry = InstanceReader(self._materials, links)
        self._lights = LightReader(links)
        self._others = Diagnostics()
        self._instancers: set[int] = set()  # session_uids
        self._scene: Scene | None = None

    def read(
        self,
        depsgraph: bpy.types.Depsgraph,
        shown: Callable[[bpy.types.Object], bool] = everywhere,
        whole: bool = False,
    ) -> Scene:
        """The Scene by now: only what the depsgraph's updates name is read again, or all that stands in it.

        `shown` says whether an object that stands for itself, or makes others stand, is wanted.
        """
        changed = depsgraph_updates.read(depsgraph, self._instancers)
        self._geometry.invalidate(changed.shapes)
        recolored = self._scene is not None and self._scene.working_space != images.working_space()
        if changed.images or recolored:
            self._materials.forget_images()
            whole |= recolored
        for material in changed.materials:
            whole |= self._materials.renew(material)  # meshes have to be read with other UV layers
        if whole or changed.whole or self._scene is None:
            self._walk(depsgraph, shown)
        else:
            self._renew(changed, depsgraph.view_layer_eval)
        self._scene = self._tables(depsgraph)
        return self._scene

    def invalidate(self) -> None:
        """Nothing that was read need hold any more; what turns out to do is the same object, all the same."""
        self._geometry.invalidate_all()
        self._materials.forget_images()

    def _walk(self, depsgraph: bpy.types.Depsgraph, shown: Callable[[bpy.types.Object], bool]) -> None:
        """Everything that stands in the scene."""
        view_layer = depsgraph.view_layer_eval
        self._others = Diagnostics()
        missing_libraries.note_missing(depsgraph, self._others)
        self._instancers.clear()
        parts = self._materials, self._geometry, self._lights
        for part in parts:
            part.begin()
        for instance in depsgraph.object_instances:
            if instance.is_instance:
                self._instancers.add(instance.parent.original.session_uid)
            if not instance.show_self or not shown(instance.parent if instance.is_instance else instance.object):
                continue
            kind = instance.object.type
            if kind == "MESH":
                if not view_layer.use_solid:
                    continue
                self._geometry.add(instance, view_layer)
            elif kind == "LIGHT":
                self._lights.add(instance)
            elif kind in UNDRAWN:
                self._others.note(f"{UNDRAWN[kind]} are not drawn by this engine", instance.object.name)

    def _renew(self, changed: depsgraph_updates.Updates, view_layer: bpy.types.ViewLayer) -> None:
        """Only what changed, all of which stands for itself."""
        for source in changed.objects:
            if source.type == "MESH":
                self._geometry.renew(source, view_layer)
            elif source.type == "LIGHT":
                self._lights.renew(source)

    def _tables(self, depsgraph: bpy.types.Depsgraph) -> Scene:
        findings, last = Diagnostics(), self._scene
        findings.include(self._others)
        unsupported_scene.note(depsgraph, findings)
        meshes, instances = self._geometry.tables(findings)
        read = Scene(
            meshes=meshes,
            instances=instances,
            materials=self._materials.table(findings),
            images=self._materials.images(),
            lights=self._lights.table(findings),
            world=world.read(_world(depsgraph), findings),
            warnings=findings.sentences(),
            working_space=images.working_space(),
        )
        return read if last is None else read.sharing(last)


def _world(depsgraph: bpy.types.Depsgraph) -> bpy.types.World | None:
    """The view layer's own, or the scene's, unless the view layer wants none."""
    view_layer = depsgraph.view_layer_eval
    override = getattr(view_layer, "world_override", None)  # since Blender 4.3
    return (override or depsgraph.scene_eval.world) if view_layer.use_sky else None
