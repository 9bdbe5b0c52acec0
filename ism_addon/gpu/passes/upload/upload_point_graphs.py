# SPDX-License-Identifier: GPL-3.0-or-later
"""Upload what shaders need to evaluate graphs where rays meet surfaces."""

from typing import Any

import numpy as np

from ....resources import (
    ATTRIBUTE_BUFFERS,
    INSTANCE_BUFFERS,
    MATERIAL_BUFFERS,
    MESH_BUFFERS,
    POINT_GRAPHS,
    UV_BUFFERS,
)
from ....scene import Change, Image, NodeGraph, Scene
from ...buffers.corner_buffers import attribute_uniforms
from ...buffers.texture_buffer import image_constants
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.shader_records import (
    GRAPH_CONSTANT,
    IMAGE,
    INSTANCE,
    MATERIAL_EMISSION,
    MATERIAL_TRANSPARENCY,
    OBJECT_INFO,
)
from ...materials.compiler import point_functions
from ...materials.point_graphs import EVEN, OPAQUE, RECORDS, PointGraphs, ScenePointGraphs


class UploadPointGraphs(Pass):
    """Upload what passes through surfaces, for camera rays and for shadow rays, and what they emit, as graphs."""

    schedule = Schedule.FIRST
    inputs = Change.MATERIALS, MESH_BUFFERS, UV_BUFFERS, ATTRIBUTE_BUFFERS, INSTANCE_BUFFERS, MATERIAL_BUFFERS
    outputs = outputs(POINT_GRAPHS)

    def needed(self, frame: Frame) -> bool:
        return any(frame.scene.has_transparency) or frame.scene.has_emission_graphs

    def execute(self, frame: Frame) -> None:
        camera, shadow = (
            self.transparency(frame, column) if passes else OPAQUE
            for column, passes in enumerate(frame.scene.has_transparency)
        )
        hits, points = {"transparent_hits": frame.scene.transparent_bounces}, instance_uniforms(frame)
        frame[POINT_GRAPHS] = ScenePointGraphs(
            camera if camera is OPAQUE else camera.with_uniforms(points),
            shadow if shadow is OPAQUE else shadow.with_uniforms(hits),
            self.emission(frame).with_uniforms(points) if frame.scene.has_emission_graphs else EVEN,
            shadow if shadow is OPAQUE else shadow.with_uniforms(points),
        )

    def transparency(self, frame: Frame, column: int) -> PointGraphs:
        """What passes, by the graphs in a column of Materials.transparency."""
        scene, table = frame.scene, frame.scene.materials.transparency
        rows = np.zeros(len(table), MATERIAL_TRANSPARENCY.dtype)
        rows["graphs"] = np.stack([numbered(each) for each in table.T], 1)
        rows["first_constants"] = scene.materials.transparency_constant
        written = MATERIAL_TRANSPARENCY.write(frame.scene_records, "transparency_graphs", rows)
        fields = f"graphs.{'xy'[column]}", f"first_constants.{'xy'[column]}"
        firsts = scene.materials.transparency_constant[:, column]
        evaluated = self.evaluated(frame, table[:, column], firsts, "transparency", MATERIAL_TRANSPARENCY.name, fields)
        uniforms = evaluated.uniforms | {"transparency_graphs": written}
        return PointGraphs(evaluated.constants | {"transparency": 1}, evaluated.parts, uniforms)

    def emission(self, frame: Frame) -> PointGraphs:
        """What the camera sees emitted, by Materials.emission_graph."""
        materials = frame.scene.materials
        rows = np.zeros(len(materials.emission_graph), MATERIAL_EMISSION.dtype)
        rows["graph"], rows["first_constant"] = numbered(materials.emission_graph), materials.emission_constant
        table = MATERIAL_EMISSION.write(frame.scene_records, "emission_graphs", rows)
        fields = "graph", "first_constant"
        graphs = materials.emission_graph, materials.emission_constant
        evaluated = self.evaluated(frame, *graphs, "emission", MATERIAL_EMISSION.name, fields)
        uniforms = evaluated.uniforms | {"emission_graphs": table}
        return PointGraphs(evaluated.constants | {"emission_graphs": 1}, evaluated.parts, uniforms)

    @staticmethod
    def evaluated(
        frame: Frame, indices: np.ndarray, firsts: np.ndarray, member: str, table: str, fields: tuple[str, str]
    ) -> PointGraphs:
        """What evaluates graphs: of materials the indices (M,) and the first constants (M,). See point_functions."""
        scene, texels = frame.scene, frame[MATERIAL_BUFFERS].texels
        graphs: list[NodeGraph] = [scene.graphs[k] for k in np.unique(indices).tolist() if k >= 0]
        rows = np.zeros(len(scene.materials.constants), GRAPH_CONSTANT.dtype)
        rows["numbers"] = scene.materials.constants
        constants = {"in_scene_records": 1}
        uniforms: dict[str, Any] = {
            "graph_constants": GRAPH_CONSTANT.write(frame.scene_records, "graph_constants", rows)
        }
        if any(graph.uses("image") for graph in graphs):
            uniforms |= {"images": IMAGE.write(frame.scene_records, "images", texels.rows), **texels.textures}
            constants |= image_constants(images_of(scene, indices, firsts))
        if any(graph.uses("uv_map") for graph in graphs):
            uniforms["uvs"] = frame[UV_BUFFERS].texture
        if any(graph.uses("mesh_attribute") for graph in graphs):
            uniforms |= attribute_uniforms(frame[ATTRIBUTE_BUFFERS])
        if any(graph.reads_objects for graph in graphs):
            rows_of_objects = frame[INSTANCE_BUFFERS].object_info
            info = OBJECT_INFO.write(frame.scene_records, "object_info", rows_of_objects)
            uniforms |= {"instances": transforms(frame), "object_info": info}
        if any(graph.uses("instance_attribute") for graph in graphs):
            uniforms |= frame[INSTANCE_BUFFERS].attributes
        return PointGraphs(constants, (*RECORDS, point_functions(graphs, member, table, fields)), uniforms)


def images_of(scene: Scene, indices: np.ndarray, firsts: np.ndarray) -> list[Image]:
    """The images that graphs of these indices (M,) and first constants (M,) read: others need no samplers."""
    used = set[int]()
    for index, first in zip(indices[indices >= 0].tolist(), firsts[indices >= 0].tolist(), strict=True):
        used.update(scene.graphs[index].images(scene.materials.constants[first:]))
    return [scene.images[index] for index in sorted(used)]


def numbered(indices: np.ndarray) -> np.ndarray:
    """(M,) indices of graphs among only these, -1 for -1: shaders stay the same if the scene has others."""
    return np.where(indices < 0, -1, np.searchsorted(np.unique(indices[indices >= 0]), indices))


def instance_uniforms(frame: Frame) -> dict[str, Any]:
    """Uniforms of surfaces/shading_point.glsl."""
    normals = frame[MESH_BUFFERS].samplers["corner_normal_buffer"]
    return {"instances": transforms(frame), "corner_normal_buffer": normals}


def transforms(frame: Frame) -> Any:
    """The instances' matrices among the scene's records."""
    return INSTANCE.write(frame.scene_records, "instances", frame[INSTANCE_BUFFERS].transforms)
