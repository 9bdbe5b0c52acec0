# SPDX-License-Identifier: GPL-3.0-or-later
"""The visible surfaces: depth, position, normals and base color, fetched from the visibility buffer's triangles.

Beck-Norén & Valter 2013, section 3.3, also store depth, normals and positions.
"""

from typing import Any

from ....resources import (
    ATTRIBUTE_BUFFERS,
    BACKGROUND_DEPTH,
    BASE_COLOR,
    DEPTH,
    INSTANCE_BUFFERS,
    MATERIAL_BUFFERS,
    MATERIAL_VALUES,
    MESH_BUFFERS,
    NORMAL,
    POSITION,
    PRIMITIVE,
    TERMINATOR_OFFSET,
    TILES,
    UV_BUFFERS,
    VISIBILITY_BUFFER,
)
from ....scene import Change
from ...buffers.corner_buffers import AttributeBuffers
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl import shader_records
from ...gl.shader_compiler import bind
from ...gl.shader_records import INSTANCE, OBJECT_INFO
from ...material_inputs import MATERIAL

#: Records that the shader fetches.
RECORDS = INSTANCE, OBJECT_INFO, shader_records.MATERIAL, shader_records.IMAGE


class GBuffer(Pass):
    """Depth along the view's axis, position, normals and base color of each pixel's nearest surface."""

    inputs = (
        *(VISIBILITY_BUFFER, MESH_BUFFERS, INSTANCE_BUFFERS, MATERIAL_BUFFERS, UV_BUFFERS, ATTRIBUTE_BUFFERS, TILES),
        *(Change.VIEW, Change.SAMPLE, "shortcuts"),
    )
    outputs = outputs(PRIMITIVE, DEPTH, POSITION, NORMAL, TERMINATOR_OFFSET) | dict.fromkeys(
        MATERIAL, (MATERIAL_BUFFERS,)
    )

    def execute(self, frame: Frame) -> None:
        frame.device.overwrite()
        first, size = frame.grid.bounds(*frame.size)
        materials, targets = frame[MATERIAL_BUFFERS], (DEPTH, POSITION, NORMAL, BASE_COLOR, PRIMITIVE)
        framebuffer = frame.framebuffer(*targets, *MATERIAL_VALUES)
        locations: dict[str, Any] = {
            f"{each.name}_location": location for location, each in enumerate(MATERIAL_VALUES, len(targets))
        }
        for graph in materials.graphs:
            shader = materials.shader(graph)
            program = self.tile_program(
                *RECORDS,
                *shader.includes,
                background_depth=BACKGROUND_DEPTH,
                **locations,
                **shader.constants,
            )
            bind(
                program,
                visibility_buffer=frame[VISIBILITY_BUFFER],
                fine_from_pixel=tuple(frame.grid.fine_from_pixel.T.ravel()),
                first=tuple(first),
                last=tuple(size - 1),
                instances=frame[INSTANCE_BUFFERS].table,
                materials=materials.table,
                **shader.samplers,
                **frame[MESH_BUFFERS].samplers,
                **({"uvs": frame[UV_BUFFERS].texture} if shader.reads_uvs else {}),
                **({"object_info": frame[INSTANCE_BUFFERS].info} if shader.reads_objects else {}),
                **(attribute_uniforms(frame[ATTRIBUTE_BUFFERS]) if shader.reads_attributes else {}),
            )
            if len(materials.graphs) > 1:
                bind(program, own_graph=graph, background_graph=materials.graphs[0])
            draw_tiles(frame, framebuffer, program)


def attribute_uniforms(buffers: AttributeBuffers) -> dict[str, Any]:
    """Uniforms of nodes/point.glsl."""
    return {"attributes": buffers.texture, "attribute_count": buffers.count}
