# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads instances of meshes. A mesh is read once for each list of materials, and kept until it changes."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from typing import NamedTuple

import bpy
import numpy as np
from mathutils import Matrix

from ....scene import Instances, Mesh
from ....scene.limits import MAX_DISTANCE, is_invertible, is_within
from ..diagnostics import Diagnostics
from ..light_linking import LightLinks, warn_of_many_groups
from ..materials.materials import MaterialReader
from . import meshes
from .geometry_instances import warn_of_unknown
from .instance_attributes import InstanceAttribute, InstanceAttributeReader, Numbers, attribute_table
from .needs import Needs
from .random_ids import random_number
from .raw_meshes import Raw

#: Thickness of objects that are scaled to nothing in one direction, relative to their largest scale.
THICKNESS = 1e-5

#: Corners of pending meshes above which these are triangulated together.
MAX_PENDING_CORNERS = 1 << 15


@dataclass(eq=False)
class _Reading:
    """The result of reading a mesh: None if it has no triangles, or before it is triangulated."""

    mesh: Mesh | None
    findings: Diagnostics


class _Pending(NamedTuple):
    """A mesh that was read and will be triangulated together with others."""

    reading: _Reading
    raw: Raw
    name: str  # of the object
    key: tuple  # its session_uid, materials, and what they need


class _Row(NamedTuple):
    """One row of Instances."""

    reading: _Reading
    world_from_object: Matrix  # a copy
    visible: bool
    casts_shadow: bool
    visible_diffuse: bool
    receivers: int
    blockers: int
    info: tuple[tuple[float, ...], int, float] | None  # color, pass index, random number, if any graph reads them
    attributes: dict[InstanceAttribute, Numbers]  # that graphs read
    linked_by: tuple[int, ...]  # session_uids of the object, and of its instancer
    name: str
    unsupported: Diagnostics  # of the object, shared with its other instances


class InstanceReader:
    """Reads instances, incrementally."""

    def __init__(self, materials: MaterialReader, links: LightLinks) -> None:
        self._materials = materials
        self._links = links
        self._attributes = InstanceAttributeReader()
        #: By the evaluated mesh's address, which Blender may reuse, and its materials with what they need.
        self._readings: dict[tuple, _Reading] = {}
        self._changed: frozenset[int] = frozenset()
        self._reread: set[tuple] = set()
        self._pending: list[_Pending] = []
        self._corners = 0  # of the pending meshes
        self._previous: dict[tuple, Mesh] = {}
        self._unsupported: dict[int, Diagnostics] = {}
        self._rows: list[_Row] = []
        self._object_rows: dict[int, int] = {}  # row of each object that is not an instance, by session_uid

    def invalidate(self, changed: frozenset[int]) -> None:
        """Read the meshes of the objects with these session_uids again."""
        self._changed = changed
        self._reread.clear()

    def invalidate_all(self) -> None:
        """Read all meshes again."""
        self._readings.clear()
        self._pending.clear()

    def reset(self) -> None:
        """To be called before all instances are added."""
        self._rows.clear()
        self._object_rows.clear()
        self._unsupported.clear()
        self._attributes.forget()

    def add(self, instance: bpy.types.DepsgraphObjectInstance, view_layer: bpy.types.ViewLayer) -> None:
        """Add one object or instance with a mesh."""
        source = instance.object
        owners = (source, instance.parent) if instance.is_instance else (source,)
        if not instance.is_instance:
            self._object_rows[source.original.session_uid] = len(self._rows)
        only_instance = instance if instance.is_instance else None
        self._rows.append(self._row(source, instance.matrix_world, owners, view_layer, only_instance))

    def update(self, source: bpy.types.Object, view_layer: bpy.types.ViewLayer) -> None:
        """Read an object that is not an instance again; ignored if it was not added, so it is not visible."""
        index = self._object_rows.get(source.original.session_uid)
        if index is not None:
            self._unsupported.pop(source.original.session_uid, None)
            self._rows[index] = self._row(source, source.matrix_world, (source,), view_layer)

    def tables(self, findings: Diagnostics) -> tuple[tuple[Mesh, ...], Instances]:
        """All meshes with instances, and the instances. Meshes without instances are released."""
        self._attributes.forget()
        self._triangulate()
        self._release_unused()
        rows = [row for row in self._rows if row.reading.mesh is not None]
        elements = chain.from_iterable(chain.from_iterable(row.world_from_object for row in rows))
        matrices = np.fromiter(elements, np.float64, 16 * len(rows)).reshape(-1, 4, 4)  # 7 times as fast as array()
        matrices[:, 3] = 0.0, 0.0, 0.0, 1.0  # exactly; parent inverses leave rounding errors in Blender's
        within_limits = is_within(matrices).all((1, 2))
        linear = np.where(within_limits.reshape(-1, 1, 1), matrices[:, :3, :3], 0.0)
        valid = within_limits & is_invertible(linear)
        flat = np.flatnonzero(within_limits & ~valid)
        if len(flat):
            matrices[flat, :3, :3] = with_thickness(linear[flat])
            valid[flat] = is_invertible(matrices[flat, :3, :3])
        for issues in dict.fromkeys(each for row in self._rows for each in (row.reading.findings, row.unsupported)):
            findings.merge(issues)
        for index in np.flatnonzero(~valid):
            issue = f"Objects scaled to nothing in two directions, or beyond {MAX_DISTANCE:g} m, are left out"
            findings.warn(issue, rows[index].name)
        valid_rows = [row for row, is_valid in zip(rows, valid.tolist(), strict=True) if is_valid]
        indices: dict[Mesh, int] = {}
        meshes = (row.reading.mesh for row in valid_rows)
        mesh_of_row = [indices.setdefault(mesh, len(indices)) for mesh in meshes if mesh is not None]
        groups = {owner: self._links.of(owner) for owner in {row.linked_by for row in valid_rows}}
        instances = Instances.of(
            mesh=mesh_of_row,
            world_from_object=matrices[valid],
            visible=[row.visible for row in valid_rows],
            casts_shadow=[row.casts_shadow for row in valid_rows],
            groups=[groups[row.linked_by] for row in valid_rows],
            visible_diffuse=[row.visible_diffuse for row in valid_rows],
            receivers=[row.receivers for row in valid_rows],
            blockers=[row.blockers for row in valid_rows],
            **object_info(valid_rows),
            attributes=attribute_table([row.attributes for row in valid_rows], self._materials.instance_attributes),
        )
        return tuple(indices), instances

    def _release_unused(self) -> None:
        used = {id(row.reading) for row in self._rows}
        self._readings = {key: reading for key, reading in self._readings.items() if id(reading) in used}
        used_meshes = {reading.mesh for reading in self._readings.values()}
        self._previous = {key: mesh for key, mesh in self._previous.items() if mesh in used_meshes}

    def _row(
        self,
        source: bpy.types.Object,
        world_from_object: Matrix,
        owners: tuple[bpy.types.Object, ...],
        view_layer: bpy.types.ViewLayer,
        instance: bpy.types.DepsgraphObjectInstance | None = None,
    ) -> _Row:
        uid, materials = source.original.session_uid, self._slots(source, view_layer)
        needs = [self._materials.needs(index) for index in materials]
        wanted = dict.fromkeys(each for need in needs for each in need.instance_attributes)
        if uid not in self._unsupported:
            self._unsupported[uid] = _unsupported_features(source, owners[-1], view_layer)
            if instance is not None and any(each.type == "INSTANCER" for each in wanted):
                warn_of_unknown(instance.parent, self._unsupported[uid])
        receivers, blockers = (self._links.of_light(owners, role) for role in ("receiver", "blocker"))
        if receivers is None or blockers is None:
            warn_of_many_groups(self._unsupported[uid], source.name)
        info, random_id = None, None if instance is None else instance.random_id
        if any(each.objects for each in needs):
            info = tuple(owners[-1].color), source.pass_index, random_number(random_id, source.name)
        return _Row(
            self._mesh(source, owners, materials),
            world_from_object.copy(),
            all(each.visible_camera for each in owners) and not owners[-1].indirect_only_get(view_layer=view_layer),
            all(each.visible_shadow for each in owners),
            all(each.visible_diffuse for each in owners),
            -1 if receivers is None else receivers,
            -1 if blockers is None else blockers,
            info,
            {each: self._attributes.read(each, source, view_layer, instance) for each in wanted},
            tuple(each.original.session_uid for each in owners),
            source.name,
            self._unsupported[uid],
        )

    def _slots(self, source: bpy.types.Object, view_layer: bpy.types.ViewLayer) -> tuple[int, ...]:
        """The materials of an object's slots, at least one."""
        override = view_layer.material_override
        slots = [override or slot.material for slot in source.material_slots] or [override]
        return tuple(self._materials.index(material) for material in slots)

    def _mesh(
        self, source: bpy.types.Object, owners: tuple[bpy.types.Object, ...], materials: tuple[int, ...]
    ) -> _Reading:
        """An object's mesh with its materials."""
        needs = tuple(self._materials.needs(index) for index in materials)
        key = (source.data.as_pointer(), materials, needs)
        changed = any(each.original.session_uid in self._changed for each in owners)
        if key not in self._readings or (changed and key not in self._reread):
            self._readings[key] = self._read(source, materials, needs)
            self._reread.add(key)
        return self._readings[key]

    def _read(self, source: bpy.types.Object, materials: tuple[int, ...], needs: tuple[Needs, ...]) -> _Reading:
        """Read a mesh. It is triangulated when enough corners are pending, or in tables()."""
        reading, raw = _Reading(None, Diagnostics()), _raw(source, materials, needs)
        if raw is not None:
            key = source.original.session_uid, materials, needs
            self._pending.append(_Pending(reading, raw, source.name, key))
            self._corners += len(raw.vertices)
            if self._corners > MAX_PENDING_CORNERS:
                self._triangulate()
        return reading

    def _triangulate(self) -> None:
        """Triangulate the pending meshes. A mesh that is equal to its previous version is the same Mesh object."""
        for pending, triangulated in zip(
            self._pending, meshes.triangulated([each.raw for each in self._pending]), strict=True
        ):
            findings = pending.reading.findings
            findings.warn("Triangles without area are left out", pending.name, triangulated.without_area)
            issue = f"Triangles with corners that are no numbers, or beyond {MAX_DISTANCE:g} m, are left out"
            findings.warn(issue, pending.name, triangulated.beyond_limits)
            mesh, last = triangulated.mesh, self._previous.get(pending.key)
            if mesh is not None and last is not None and mesh.equals(last):
                mesh = last
            if mesh is not None:
                self._previous[pending.key] = mesh
            pending.reading.mesh = mesh
        self._pending.clear()
        self._corners = 0


def _raw(source: bpy.types.Object, materials: tuple[int, ...], needs: tuple[Needs, ...]) -> Raw | None:
    """An object's mesh, from a temporary copy: it shares all arrays, and data computed on reading stays in the copy.

    A mesh in edit mode has to be copied in any case.
    """
    try:
        layers, attributes, *_ = zip(*needs, strict=True)
        return meshes.read(source.to_mesh(), materials, layers, attributes)
    finally:
        source.to_mesh_clear()


def object_info(rows: Sequence[_Row]) -> dict[str, Sequence]:
    """The fields of Instances that graphs read, without rows if none does."""
    if not any(row.info is not None for row in rows):
        return {"color": [], "pass_index": [], "random": []}
    colors, indices, numbers = zip(*(row.info or ((1.0, 1.0, 1.0, 1.0), 0, 0.0) for row in rows), strict=True)
    return {"color": colors, "pass_index": indices, "random": numbers}


def _unsupported_features(
    source: bpy.types.Object, instancer: bpy.types.Object, view_layer: bpy.types.ViewLayer
) -> Diagnostics:
    """Unsupported features of an object and its instancer, which is the object itself if it is no instance."""
    findings = Diagnostics()
    if source.is_holdout or instancer.holdout_get(view_layer=view_layer):
        findings.warn("Holdouts are drawn as plain surfaces", source.name)
    if source.is_shadow_catcher or instancer.is_shadow_catcher:
        findings.warn("Shadow catchers are drawn as plain surfaces", source.name)
    settings = (system.settings for system in source.particle_systems)
    if any(each.type == "HAIR" and each.render_type == "PATH" for each in settings):
        findings.warn("Hair strands are not drawn by this engine", source.name)
    return findings


def with_thickness(linear: np.ndarray) -> np.ndarray:
    """Matrices (N,3,3) that are not invertible, with a thickness where they flatten objects to planes.

    Zeros where they leave less than a plane.
    """
    u, scales, v = np.linalg.svd(linear)
    scales[:, 2] = THICKNESS * scales[:, 0]
    scales[scales[:, 1] <= scales[:, 2]] = 0.0
    return (u * scales[:, None]) @ v
