# SPDX-License-Identifier: GPL-3.0-or-later
"""Where meshes stand. Each is read once for each list of materials that it stands with, and kept until it changes."""

from dataclasses import dataclass
from itertools import chain
from typing import NamedTuple

import bpy
import numpy as np
from mathutils import Matrix

from ....scene import Instances, Mesh
from ....scene.limits import MAX_DISTANCE, is_invertible, is_within
from ..diagnostics import Diagnostics
from ..light_linking import LightLinks
from ..materials.materials import MaterialReader
from . import meshes
from .raw_meshes import Raw

#: Corners of meshes that are read before they are made into triangles.
MESHES_AT_A_TIME = 1 << 15


@dataclass(eq=False)
class _Reading:
    """What was read of a mesh, None where it has no triangle, or before it is made."""

    mesh: Mesh | None
    findings: Diagnostics


class _Waiting(NamedTuple):
    """A mesh that was read and is to be made, with others."""

    reading: _Reading
    raw: Raw
    name: str  # of the object
    key: tuple  # its session_uid, materials, and their UV layers


class _Row(NamedTuple):
    """One row of Instances."""

    reading: _Reading
    world_from_object: Matrix  # a copy
    visible: bool
    casts_shadow: bool
    linked_by: tuple[int, ...]  # session_uids of the object, and of what makes it stand
    name: str
    unlike: Diagnostics  # of the object, shared with its other instances


class InstanceReader:
    """Collects instances, from one depsgraph after another."""

    def __init__(self, materials: MaterialReader, links: LightLinks) -> None:
        self._materials = materials
        self._links = links
        self._readings: dict[tuple, _Reading] = {}  # by the evaluated mesh's address, which may come to hold another
        self._changed: frozenset[int] = frozenset()
        self._renewed: set[tuple] = set()
        self._waiting: list[_Waiting] = []
        self._corners = 0  # of those
        self._last: dict[tuple, Mesh] = {}
        self._unlike: dict[int, Diagnostics] = {}
        self._rows: list[_Row] = []
        self._own: dict[int, int] = {}  # the row of an object that stands for itself, by its session_uid

    def invalidate(self, changed: frozenset[int]) -> None:
        """What was read for the objects of these session_uids no longer holds."""
        self._changed = changed
        self._renewed.clear()

    def invalidate_all(self) -> None:
        """Nothing that was read holds."""
        self._readings.clear()
        self._waiting.clear()

    def begin(self) -> None:
        """Before all instances are added."""
        self._rows.clear()
        self._own.clear()
        self._unlike.clear()

    def add(self, instance: bpy.types.DepsgraphObjectInstance, view_layer: bpy.types.ViewLayer) -> None:
        """One mesh where it stands."""
        source = instance.object
        shown = (source, instance.parent) if instance.is_instance else (source,)
        if not instance.is_instance:
            self._own[source.original.session_uid] = len(self._rows)
        self._rows.append(self._row(source, instance.matrix_world, shown, view_layer))

    def renew(self, source: bpy.types.Object, view_layer: bpy.types.ViewLayer) -> None:
        """An object that stands for itself has changed; one that was not shown still is not."""
        index = self._own.get(source.original.session_uid)
        if index is not None:
            self._unlike.pop(source.original.session_uid, None)
            self._rows[index] = self._row(source, source.matrix_world, (source,), view_layer)

    def tables(self, findings: Diagnostics) -> tuple[tuple[Mesh, ...], Instances]:
        """The meshes that stand somewhere, and where. What stands nowhere is let go of."""
        self._make()
        self._tidy()
        rows = [row for row in self._rows if row.reading.mesh is not None]
        numbers_of = chain.from_iterable(chain.from_iterable(row.world_from_object for row in rows))
        matrices = np.fromiter(numbers_of, np.float64, 16 * len(rows)).reshape(-1, 4, 4)  # 7 times as fast as array()
        matrices[:, 3] = 0.0, 0.0, 0.0, 1.0  # as it is in Blender's but for rounding, after parents were inverted
        in_reach = is_within(matrices).all((1, 2))
        upright = in_reach & is_invertible(np.where(in_reach.reshape(-1, 1, 1), matrices[:, :3, :3], 0.0))
        for found in dict.fromkeys(found for row in self._rows for found in (row.reading.findings, row.unlike)):
            findings.include(found)
        for index in np.flatnonzero(~upright):
            kind = f"Objects scaled to nothing in some direction, or beyond {MAX_DISTANCE:g} m, are left out"
            findings.note(kind, rows[index].name)
        placed = [row for row, kept in zip(rows, upright.tolist(), strict=True) if kept]
        numbers: dict[Mesh, int] = {}
        meshes = (row.reading.mesh for row in placed)
        of_row = [numbers.setdefault(mesh, len(numbers)) for mesh in meshes if mesh is not None]
        groups = {owner: self._links.of(owner) for owner in {row.linked_by for row in placed}}
        instances = Instances.of(
            mesh=of_row,
            world_from_object=matrices[upright],
            visible=[row.visible for row in placed],
            casts_shadow=[row.casts_shadow for row in placed],
            groups=[groups[row.linked_by] for row in placed],
        )
        return tuple(numbers), instances

    def _tidy(self) -> None:
        used = {id(row.reading) for row in self._rows}
        self._readings = {key: reading for key, reading in self._readings.items() if id(reading) in used}
        meshes_left = {reading.mesh for reading in self._readings.values()}
        self._last = {key: mesh for key, mesh in self._last.items() if mesh in meshes_left}

    def _row(
        self,
        source: bpy.types.Object,
        world_from_object: Matrix,
        shown: tuple[bpy.types.Object, ...],
        view_layer: bpy.types.ViewLayer,
    ) -> _Row:
        of_object = source.original.session_uid
        if of_object not in self._unlike:
            self._unlike[of_object] = _unsupported_features(source, shown[-1], view_layer)
        return _Row(
            self._mesh(source, shown, view_layer),
            world_from_object.copy(),
            all(each.visible_camera for each in shown) and not shown[-1].indirect_only_get(view_layer=view_layer),
            all(each.visible_shadow for each in shown),
            tuple(each.original.session_uid for each in shown),
            source.name,
            self._unlike[of_object],
        )

    def _mesh(
        self, source: bpy.types.Object, shown: tuple[bpy.types.Object, ...], view_layer: bpy.types.ViewLayer
    ) -> _Reading:
        """An object's mesh with its materials."""
        override = view_layer.material_override
        slots = [override or slot.material for slot in source.material_slots] or [override]
        materials = tuple(self._materials.index(material) for material in slots)
        layers = tuple(self._materials.uv_layer(index) for index in materials)
        key = (source.data.as_pointer(), materials, layers)
        changed = any(each.original.session_uid in self._changed for each in shown)
        if key not in self._readings or (changed and key not in self._renewed):
            self._readings[key] = self._read(source, materials, layers)
            self._renewed.add(key)
        return self._readings[key]

    def _read(self, source: bpy.types.Object, materials: tuple[int, ...], layers: tuple[str | None, ...]) -> _Reading:
        """Read it; what is read is made into triangles when it is enough, or asked for."""
        reading, raw = _Reading(None, Diagnostics()), _raw(source, materials, layers)
        if raw is not None:
            key = source.original.session_uid, materials, layers
            self._waiting.append(_Waiting(reading, raw, source.name, key))
            self._corners += len(raw.vertices)
            if self._corners > MESHES_AT_A_TIME:
                self._make()
        return reading

    def _make(self) -> None:
        """The meshes of what was read; one that turns out to be what it was before is the same Mesh."""
        for waiting, made in zip(self._waiting, meshes.made([each.raw for each in self._waiting]), strict=True):
            findings = waiting.reading.findings
            findings.note("Triangles without area are left out", waiting.name, made.without_area)
            kind = f"Triangles with corners that are no numbers, or beyond {MAX_DISTANCE:g} m, are left out"
            findings.note(kind, waiting.name, made.out_of_reach)
            mesh, last = made.mesh, self._last.get(waiting.key)
            if mesh is not None and last is not None and mesh.equals(last):
                mesh = last
            if mesh is not None:
                self._last[waiting.key] = mesh
            waiting.reading.mesh = mesh
        self._waiting.clear()
        self._corners = 0


def _raw(source: bpy.types.Object, materials: tuple[int, ...], layers: tuple[str | None, ...]) -> Raw | None:
    """An object's mesh, from a copy: it shares all arrays, but Blender makes its own of those that are read.

    What is in edit mode is in its editor's form, and has to be copied out of it in any case.
    """
    try:
        return meshes.read(source.to_mesh(), materials, layers)
    finally:
        source.to_mesh_clear()


def _unsupported_features(
    source: bpy.types.Object, standing: bpy.types.Object, view_layer: bpy.types.ViewLayer
) -> Diagnostics:
    """What of an object, and of what makes it stand, will look otherwise than the artist meant it."""
    findings = Diagnostics()
    if source.is_holdout or standing.holdout_get(view_layer=view_layer):
        findings.note("Holdouts are drawn as plain surfaces", source.name)
    if source.is_shadow_catcher or standing.is_shadow_catcher:
        findings.note("Shadow catchers are drawn as plain surfaces", source.name)
    settings = (system.settings for system in source.particle_systems)
    if any(each.type == "HAIR" and each.render_type == "PATH" for each in settings):
        findings.note("Hair strands are not drawn by this engine", source.name)
    return findings
