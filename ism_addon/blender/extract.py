# SPDX-License-Identifier: GPL-3.0-or-later
"""An evaluated depsgraph to one Scene: all that renders, copied, so nothing of bpy outlives the call.

Blender presents curves, texts, metaballs and surfaces as instances of the meshes that they evaluate to,
beside the object itself: only meshes need be read.
"""

from typing import NamedTuple

import bpy
import numpy as np

from ..scene import Instances, Mesh, Scene
from . import meshes, world
from .findings import Findings
from .lights import LightTable
from .materials import MaterialTable
from .reach import FARTHEST, within

#: Objects that render in other engines, and not in this one.
UNDRAWN = {
    "CURVES": "Hair curves",
    "POINTCLOUD": "Point clouds",
    "VOLUME": "Volumes",
    "GREASEPENCIL": "Grease pencil drawings",
    "GPENCIL": "Grease pencil drawings",
}


def scene(depsgraph: bpy.types.Depsgraph) -> Scene:
    """Everything that the depsgraph shows, with a sentence for each kind of thing that was left out."""
    findings = Findings()
    materials = MaterialTable(findings)
    lights = LightTable(findings)
    geometry = Geometry(depsgraph, materials, findings)
    for instance in depsgraph.object_instances:
        if not instance.show_self:
            continue
        kind = instance.object.type
        if kind == "MESH":
            geometry.add(instance)
        elif kind == "LIGHT":
            light = instance.object
            lights.add(light.data, np.array(instance.matrix_world, np.float64), light.name)
        elif kind in UNDRAWN:
            findings.note(f"{UNDRAWN[kind]} are not drawn by this engine", instance.object.name)
    found, instances = geometry.tables()
    return Scene(
        meshes=found,
        instances=instances,
        materials=materials.table(),
        images=materials.images(),
        lights=lights.table(),
        world=world.read(depsgraph.scene_eval.world, findings),
        warnings=findings.sentences(),
    )


class _Placed(NamedTuple):
    """One row of Instances, and whose it is."""

    mesh: int
    world_from_object: np.ndarray
    visible: bool
    casts_shadow: bool
    name: str


class Geometry:
    """Collects instances, and reads each mesh once for each list of materials that it stands with."""

    def __init__(self, depsgraph: bpy.types.Depsgraph, materials: MaterialTable, findings: Findings) -> None:
        self._view_layer = depsgraph.view_layer_eval
        self._materials = materials
        self._findings = findings
        self._of_object: dict[tuple[int, int], int | None] = {}
        self._of_mesh: dict[tuple[int, tuple[int, ...]], int | None] = {}
        self._meshes: list[Mesh] = []
        self._placed: list[_Placed] = []

    def add(self, instance: bpy.types.DepsgraphObjectInstance) -> None:
        """One mesh where it stands."""
        source = instance.object
        key = (source.original.as_pointer(), source.data.as_pointer())
        if key not in self._of_object:
            self._of_object[key] = self._mesh(source)
        mesh = self._of_object[key]
        if mesh is not None:
            shown = (source, instance.parent) if instance.is_instance else (source,)
            self._placed.append(
                _Placed(
                    mesh,
                    np.array(instance.matrix_world, np.float64),
                    all(each.visible_camera for each in shown) and not self._is_indirect_only(shown[-1]),
                    all(each.visible_shadow for each in shown),
                    source.name,
                )
            )

    def tables(self) -> tuple[tuple[Mesh, ...], Instances]:
        """The meshes that stand somewhere, and where."""
        matrices = np.array([row.world_from_object for row in self._placed]).reshape(-1, 4, 4)
        upright = _invertible(matrices)
        for index in np.flatnonzero(~upright):
            kind = f"Objects scaled to nothing in some direction, or beyond {FARTHEST:g} m, are left out"
            self._findings.note(kind, self._placed[index].name)
        placed = [row for row, kept in zip(self._placed, upright, strict=True) if kept]
        used, index = np.unique(np.array([row.mesh for row in placed], np.int32), return_inverse=True)
        instances = Instances(
            mesh=index.astype(np.int32),
            world_from_object=matrices[upright],
            visible=np.array([row.visible for row in placed], np.bool_),
            casts_shadow=np.array([row.casts_shadow for row in placed], np.bool_),
        )
        return tuple(self._meshes[mesh] for mesh in used), instances

    def _mesh(self, source: bpy.types.Object) -> int | None:
        """Index of an object's mesh with its materials, None where it has no triangle."""
        override = self._view_layer.material_override
        slots = [override or slot.material for slot in source.material_slots] or [override]
        materials = tuple(self._materials.index(material) for material in slots)
        self._note_unlike(source)
        key = (source.data.as_pointer(), materials)
        if key not in self._of_mesh:
            reading = _reading(source, materials)
            self._of_mesh[key] = len(self._meshes) if reading.mesh else None
            self._meshes += [reading.mesh] if reading.mesh else []
            self._findings.note("Triangles without area are left out", source.name, reading.without_area)
            kind = f"Triangles with corners that are no numbers, or beyond {FARTHEST:g} m, are left out"
            self._findings.note(kind, source.name, reading.out_of_reach)
        return self._of_mesh[key]

    def _note_unlike(self, source: bpy.types.Object) -> None:
        """Say what of an object will look otherwise than the artist meant it."""
        if source.is_holdout:
            self._findings.note("Holdouts are drawn as plain surfaces", source.name)
        settings = (system.settings for system in source.particle_systems)
        if any(each.type == "HAIR" and each.render_type == "PATH" for each in settings):
            self._findings.note("Hair strands are not drawn by this engine", source.name)

    def _is_indirect_only(self, source: bpy.types.Object) -> bool:
        return source.indirect_only_get(view_layer=self._view_layer)


def _reading(source: bpy.types.Object, materials: tuple[int, ...]) -> meshes.Reading:
    """An object's mesh; one in edit mode is in its editor's form, and has to be copied out of it."""
    if not source.data.is_editmode:
        return meshes.read(source.data, materials)
    try:
        return meshes.read(source.to_mesh(), materials)
    finally:
        source.to_mesh_clear()


def _invertible(matrices: np.ndarray) -> np.ndarray:
    """(I,) which of (I,4,4) stay within reach and flatten nothing, as far as float64 tells of Blender's float32."""
    linear = np.where(within(matrices).all((1, 2), keepdims=True), matrices, 0.0)[:, :3, :3]
    size = np.prod(np.linalg.norm(linear, axis=1), axis=1)
    return np.abs(np.linalg.det(linear)) > 1e-9 * size
