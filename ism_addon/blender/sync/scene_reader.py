# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads an evaluated depsgraph into a Scene: copies, with no references to bpy data.

Besides curves, texts, metaballs and surfaces themselves, Blender lists the meshes that they evaluate to, as instances.
So only meshes are read.
"""

from collections.abc import Callable

import bpy

from ...scene import Scene
from . import depsgraph_updates, missing_libraries, unsupported_scene
from .diagnostics import Diagnostics
from .geometry.instances import InstanceReader
from .light_linking import LightLinks
from .lights import LightReader
from .materials import images
from .materials.image_reader import ImageReader
from .materials.materials import MaterialReader
from .world.skies import with_suns
from .world.world_reader import WorldReader

#: Types of objects that other engines render and this one does not.
UNSUPPORTED_TYPES = {
    "CURVES": "Hair curves",
    "POINTCLOUD": "Point clouds",
    "VOLUME": "Volumes",
    "GREASEPENCIL": "Grease pencil drawings",
    "GPENCIL": "Grease pencil drawings",
}


def accept_all(_object: bpy.types.Object) -> bool:
    """The filter of final renders: all objects that the depsgraph shows."""
    return True


def scene(depsgraph: bpy.types.Depsgraph, is_shown: Callable[[bpy.types.Object], bool] = accept_all) -> Scene:
    """The Scene of the objects that the depsgraph shows and `is_shown` accepts, with warnings."""
    return Reader().read(depsgraph, is_shown)


class Reader:
    """Reads a depsgraph incrementally: what has not changed is the same object as in the last Scene."""

    def __init__(self, frees_images: bool = False) -> None:
        """With `frees_images`, Blender does not keep images that it decodes only for this reader."""
        self._images = ImageReader(frees_images)
        self._materials = MaterialReader(self._images)
        self._worlds = WorldReader(self._images)
        links = LightLinks()
        self._instances = InstanceReader(self._materials, links)
        self._lights = LightReader(links)
        self._others = Diagnostics()
        #: session_uids of the objects that make instances, and of those whose instances they are.
        self._instanced: set[int] = set()
        self._scene: Scene | None = None

    def read(
        self,
        depsgraph: bpy.types.Depsgraph,
        is_shown: Callable[[bpy.types.Object], bool] = accept_all,
        all_instances: bool = False,
    ) -> Scene:
        """The current Scene. Only what the depsgraph's updates list is read again, with `all_instances` all instances.

        `is_shown` is asked about objects, and about instancers for all of their instances.
        """
        changed = depsgraph_updates.read(depsgraph, self._instanced)
        self._instances.invalidate(changed.changed_geometry)
        has_new_working_space = self._scene is not None and self._scene.working_space != images.working_space()
        if changed.images or has_new_working_space:
            self._forget_images()
            all_instances |= has_new_working_space
        for material in changed.materials:
            all_instances |= self._materials.update(material)  # meshes need other UV layers
        all_instances |= changed.world and self._materials.reads_view_layer
        if all_instances or changed.all_instances or self._scene is None:
            self._walk(depsgraph, is_shown)
        else:
            self._update(changed, depsgraph.view_layer_eval)
        self._scene = self._tables(depsgraph)
        return self._scene

    def invalidate(self) -> None:
        """Read everything again the next time. What has not changed is still the same object."""
        self._instances.invalidate_all()
        self._forget_images()

    def _forget_images(self) -> None:
        """Read all images again, and what has them."""
        self._images.forget()
        self._materials.forget()
        self._lights.forget_images()

    def _walk(self, depsgraph: bpy.types.Depsgraph, is_shown: Callable[[bpy.types.Object], bool]) -> None:
        """Read all instances of the depsgraph."""
        view_layer = depsgraph.view_layer_eval
        self._others = Diagnostics()
        missing_libraries.warn_of_missing(depsgraph, self._others)
        self._instanced.clear()
        for reader in (self._materials, self._instances, self._lights):
            reader.reset()
        for instance in depsgraph.object_instances:
            if instance.is_instance:
                self._instanced |= {each.original.session_uid for each in (instance.parent, instance.object)}
            if not instance.show_self or not is_shown(instance.parent if instance.is_instance else instance.object):
                continue
            type_ = instance.object.type
            if type_ == "MESH":
                if not view_layer.use_solid:
                    continue
                self._instances.add(instance, view_layer)
            elif type_ == "LIGHT":
                self._lights.add(instance)
            elif type_ in UNSUPPORTED_TYPES:
                self._others.warn(f"{UNSUPPORTED_TYPES[type_]} are not drawn by this engine", instance.object.name)

    def _update(self, changed: depsgraph_updates.Updates, view_layer: bpy.types.ViewLayer) -> None:
        """Read changed objects, none of which is an instance."""
        for source in changed.objects:
            if source.type == "MESH":
                self._instances.update(source, view_layer)
            elif source.type == "LIGHT":
                self._lights.update(source)

    def _tables(self, depsgraph: bpy.types.Depsgraph) -> Scene:
        findings, previous = Diagnostics(), self._scene
        findings.merge(self._others)
        unsupported_scene.warn(depsgraph, findings)
        meshes, instances = self._instances.tables(findings)
        materials, of_world = self._materials.table(findings), self._worlds.read(_world(depsgraph), findings)
        graphs = tuple(dict.fromkeys((*self._materials.graphs(), *of_world.graphs)))
        read = Scene(
            meshes=meshes,
            instances=instances,
            materials=materials,
            images=self._images.images(),
            graphs=graphs,
            lights=with_suns(self._lights.table(findings), of_world.suns),
            light_profiles=self._lights.profiles(),
            light_images=self._lights.images(),
            world=of_world.table(graphs),
            warnings=findings.messages(),
            working_space=images.working_space(),
            transparent_bounces=_transparent_bounces(depsgraph),
        )
        return read if previous is None else read.reusing(previous)


def _transparent_bounces(depsgraph: bpy.types.Depsgraph) -> int:
    """That of Cycles, which artists set for all of a file's light; its default if Cycles is switched off."""
    cycles = getattr(depsgraph.scene_eval, "cycles", None)
    return Scene.transparent_bounces if cycles is None else cycles.transparent_max_bounces


def _world(depsgraph: bpy.types.Depsgraph) -> bpy.types.World | None:
    """The view layer's world, or the scene's; None if the view layer excludes it."""
    view_layer = depsgraph.view_layer_eval
    override = getattr(view_layer, "world_override", None)  # since Blender 4.3
    return (override or depsgraph.scene_eval.world) if view_layer.use_sky else None
