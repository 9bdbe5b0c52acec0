# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluates the emission of meshes whose materials have graphs of it, so that they light surfaces by their texture."""

from collections.abc import Container
from typing import Any

import numpy as np

from ....resources import BAKED_EMISSION, MESH_BUFFERS, POINT_GRAPHS
from ....scene import Change
from ....scene.limits import MAX_EMISSION
from ...buffers.instance_buffers import anchor_from_quanta, attribute_uniforms, instance_table, object_info
from ...drawing import evaluate_points
from ...emission.baked_emission import Bake, BakedEmission, bakes_of, key_of
from ...emission.pieces import Pieces, points_in_parts
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.shader_records import INSTANCE, OBJECT_INFO


class BakeEmission(Pass):
    """Evaluate graphs of emission all over the meshes that light surfaces by them."""

    schedule = Schedule.FIRST
    inputs = Change.MATERIALS, Change.INSTANCES, Change.EMISSION_VIEW, MESH_BUFFERS, POINT_GRAPHS
    outputs = outputs(BAKED_EMISSION)

    def needed(self, frame: Frame) -> bool:
        return frame.scene.has_emission_graphs

    def execute(self, frame: Frame) -> None:
        key, view, last = key_of(frame.scene), frame.states[Change.EMISSION_VIEW], frame.get(BAKED_EMISSION)
        if last is None or (last.key, last.view) != (key, view):
            bakes = bakes_of(frame.scene)
            frame[BAKED_EMISSION] = BakedEmission(key, view, self.pieces(frame, bakes) if bakes else {})

    def pieces(self, frame: Frame, bakes: list[Bake]) -> dict[int, Pieces]:
        """What of each instance emits, by its index: the same object for equal ones."""
        rows = np.concatenate([bake.instances for bake in bakes])
        points = np.concatenate([points_of(frame, bake, rows) for bake in bakes])
        graphs, corners = frame[POINT_GRAPHS].emission, frame[MESH_BUFFERS].samplers["corners"]
        uniforms = graphs.uniforms | tables(frame, rows, graphs.uniforms)
        shader = self.full_screen_program(*graphs.parts, **graphs.constants)
        radiance = evaluate_points(frame, shader, points, 4, corners=corners, **uniforms)[:, :3]
        radiance = np.where(np.isnan(radiance), np.float32(0.0), radiance.clip(0.0, MAX_EMISSION))
        first, found, joined = 0, dict[int, list[Pieces]](), dict[tuple[int, ...], Pieces]()
        for bake in bakes:
            end = first + bake.points * len(bake.instances)
            own = bake.pieces(frame.scene.meshes[bake.mesh], radiance[first:end])
            for row, pieces in zip(bake.instances.tolist(), own, strict=True):
                found.setdefault(row, []).append(pieces)
            first = end
        for own in found.values():
            key = tuple(map(id, own))
            if key not in joined:
                joined[key] = Pieces.joined(own)
        return {row: joined[tuple(map(id, own))] for row, own in found.items()}


def points_of(frame: Frame, bake: Bake, rows: np.ndarray) -> np.ndarray:
    """(P,8) uint32: where a bake is evaluated. `rows`: the instances in `tables`."""
    triangles = frame[MESH_BUFFERS].rows_of(np.full(len(bake.triangles), bake.mesh), bake.triangles)
    barycentric, directions = points_in_parts(len(bake.triangles), bake.depth)
    table = np.zeros((len(bake.instances), bake.sides, len(barycentric), 8), np.uint32)
    table[..., 0] = triangles.repeat(len(barycentric) // len(triangles))
    table[..., 1] = np.searchsorted(np.unique(rows), bake.instances)[:, None, None]
    table[..., 2:4] = barycentric[:, 1:].astype(np.float32).view(np.uint32)
    table[..., 4:7] = directions.astype(np.float32).view(np.uint32)
    table[..., 7] = np.arange(bake.sides)[:, None]
    return table.reshape(-1, 8)


def tables(frame: Frame, rows: np.ndarray, read: Container[str]) -> dict[str, Any]:
    """Those tables of these instances, which the camera may not see, that graphs read."""
    rows, meshes, instances, records = np.unique(rows), frame[MESH_BUFFERS], frame.scene.instances, frame.scene_records
    transforms = instance_table(*anchor_from_quanta(meshes, instances, rows, frame.anchor))
    uniforms = {"instances": INSTANCE.write(records, "emissive_instances", transforms)}
    if "object_info" in read:
        info = object_info(meshes, instances, rows)
        uniforms["object_info"] = OBJECT_INFO.write(records, "emissive_object_info", info)
    if "instance_attributes" in read:
        uniforms |= attribute_uniforms(records, "emissive_instance_attributes", instances, rows)
    return uniforms
