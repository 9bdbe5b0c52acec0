# SPDX-License-Identifier: GPL-3.0-or-later
"""Upload what rays need to pass transparent surfaces."""

from typing import Any

import numpy as np

from ....resources import (
    ATTRIBUTE_BUFFERS,
    INSTANCE_BUFFERS,
    MATERIAL_BUFFERS,
    MESH_BUFFERS,
    TRANSPARENCY,
    UV_BUFFERS,
)
from ....scene import Change, NodeGraph
from ...buffers.corner_buffers import attribute_uniforms
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.shader_records import GRAPH_CONSTANT, IMAGE, INSTANCE, MATERIAL_TRANSPARENCY, OBJECT_INFO
from ...materials.compiler import transparency_glsl
from ...materials.transparency import CAMERA, OPAQUE, RECORDS, SHADOW, RayTransparency, SceneTransparency


class UploadTransparency(Pass):
    """Upload what passes through surfaces, as graphs for camera rays and for shadow rays."""

    schedule = Schedule.FIRST
    inputs = Change.MATERIALS, MESH_BUFFERS, UV_BUFFERS, ATTRIBUTE_BUFFERS, INSTANCE_BUFFERS, MATERIAL_BUFFERS
    outputs = outputs(TRANSPARENCY)

    def needed(self, frame: Frame) -> bool:
        return any(frame.scene.has_transparency)

    def execute(self, frame: Frame) -> None:
        materials = frame.scene.materials
        table = np.zeros(len(materials.transparency), MATERIAL_TRANSPARENCY.dtype)
        table["graphs"], table["first_constants"] = materials.transparency, materials.transparency_constant
        constants = np.zeros(len(materials.constants), GRAPH_CONSTANT.dtype)
        constants["numbers"] = materials.constants
        tables = {
            "transparencies": MATERIAL_TRANSPARENCY.write(frame.scene_records, "transparencies", table),
            "graph_constants": GRAPH_CONSTANT.write(frame.scene_records, "graph_constants", constants),
        }
        rays = zip((CAMERA, SHADOW), frame.scene.has_transparency, strict=True)
        frame[TRANSPARENCY] = SceneTransparency(
            *(self.of_rays(frame, k, column, tables) if any_ else OPAQUE for k, (column, any_) in enumerate(rays))
        )

    def of_rays(self, frame: Frame, index: int, column: str, tables: dict[str, Any]) -> RayTransparency:
        """For one type of rays: the graphs in a column of Materials.transparency."""
        scene, texels = frame.scene, frame[MATERIAL_BUFFERS].texels
        indices = np.unique(scene.materials.transparency[:, index])
        graphs: dict[int, NodeGraph] = {k: scene.graphs[k] for k in indices.tolist() if k >= 0}
        uniforms, constants = dict(tables), {"transparency": 1, "in_scene_records": 1}
        if any(graph.uses("image") for graph in graphs.values()):
            uniforms |= {"images": IMAGE.write(frame.scene_records, "images", texels.rows), **texels.textures}
            constants |= texels.constants
        if any(graph.uses("uv_map") for graph in graphs.values()):
            uniforms["uvs"] = frame[UV_BUFFERS].texture
        if any(graph.uses("mesh_attribute") for graph in graphs.values()):
            uniforms |= attribute_uniforms(frame[ATTRIBUTE_BUFFERS])
        instances, reads_objects = frame[INSTANCE_BUFFERS], any(graph.reads_objects for graph in graphs.values())
        if index == 0 or reads_objects:
            uniforms["instances"] = INSTANCE.write(frame.scene_records, "instances", instances.transforms)
        if reads_objects:
            uniforms["object_info"] = OBJECT_INFO.write(frame.scene_records, "object_info", instances.object_info)
        if index == 1:
            uniforms["transparent_hits"] = scene.transparent_bounces
        return RayTransparency(constants, (*RECORDS, transparency_glsl(graphs, column)), uniforms)
