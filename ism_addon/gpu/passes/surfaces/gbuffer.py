# SPDX-License-Identifier: GPL-3.0-or-later
"""The visible surfaces: depth, position, normals and base color, fetched from the visibility buffer's triangles.

Beck-Norén & Valter 2013, section 3.3, also store depth, normals and positions.
"""

from functools import cached_property
from typing import Any

import moderngl

from ....resource_types import Target
from ....resources import (
    ATTRIBUTE_BUFFERS,
    BACKGROUND_DEPTH,
    BASE_COLOR,
    DEPTH,
    INSTANCE_BUFFERS,
    MATERIAL_BUFFERS,
    MESH_BUFFERS,
    NORMAL,
    POSITION,
    PRIMITIVE,
    TERMINATOR_OFFSET,
    TILE_GRAPHS,
    TILES,
    UV_BUFFERS,
    VISIBILITY_BUFFER,
)
from ....scene import Change
from ...buffers.corner_buffers import attribute_uniforms
from ...buffers.material_buffers import MaterialBuffers
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl import shader_records
from ...gl.buffer_texture import BufferTexture
from ...gl.shader_compiler import ShaderError, bind
from ...gl.shader_records import INSTANCE, OBJECT_INFO, Record
from ...material_inputs import GLOSS, MATERIAL, layer_targets, lobe_targets, material_constants
from ...materials import lobe_tables
from ...surface_inputs import visible_triangle_uniforms

#: Records that the shader fetches.
RECORDS: tuple[Record, ...] = INSTANCE, OBJECT_INFO, shader_records.MATERIAL, shader_records.IMAGE


class GBuffer(Pass):
    """Depth along the view's axis, position, normals and base color of each pixel's nearest surface."""

    inputs = (
        *(VISIBILITY_BUFFER, MESH_BUFFERS, INSTANCE_BUFFERS, MATERIAL_BUFFERS, UV_BUFFERS, ATTRIBUTE_BUFFERS, TILES),
        *(TILE_GRAPHS, Change.NORMALS, Change.VIEW, Change.SAMPLE, "shortcuts"),
    )
    outputs = outputs(PRIMITIVE, DEPTH, POSITION, NORMAL, TERMINATOR_OFFSET) | dict.fromkeys(
        MATERIAL, (MATERIAL_BUFFERS,)
    )

    @cached_property
    def lobe_tables(self) -> BufferTexture:
        return self.device.buffer_from(lobe_tables.texture_rows())

    def execute(self, frame: Frame) -> None:
        frame.device.overwrite()
        scene, targets = frame.scene, (DEPTH, POSITION, NORMAL, BASE_COLOR, PRIMITIVE)
        for target in lobe_targets(scene):
            frame.allocate(target, frame.size)
        self.draw(frame, (*targets, *(GLOSS if scene.has_gloss else ())), layers=0)
        if layers := layer_targets(scene):
            self.draw(frame, layers, layers=1)

    def draw(self, frame: Frame, targets: tuple[Target, ...], layers: int) -> None:
        """Draw targets with the program of each graph. `layers`: 1 for layer_targets, or 0."""
        materials, framebuffer = frame[MATERIAL_BUFFERS], frame.framebuffer(*targets)
        constants: dict[str, Any] = {
            "background_depth": BACKGROUND_DEPTH,
            "layers": layers,
            **material_constants(frame),
        }
        if frame.scene.has_gloss:
            constants |= {"rare_location": len(targets) - 1}
        for graph, program in self.programs(frame, materials, constants).items():
            shader = materials.shader(graph)
            bind(
                program,
                **visible_triangle_uniforms(frame),
                instances=frame[INSTANCE_BUFFERS].table,
                materials=materials.table,
                **shader.samplers,
                **frame[MESH_BUFFERS].samplers,
                **({"uvs": frame[UV_BUFFERS].texture} if shader.reads_uvs else {}),
                **({"object_info": frame[INSTANCE_BUFFERS].info} if shader.reads_objects else {}),
                **({"lobe_tables": self.lobe_tables} if shader.has_gloss else {}),
                **(attribute_uniforms(frame[ATTRIBUTE_BUFFERS]) if shader.reads_attributes else {}),
            )
            if len(materials.graphs) > 1:
                bind(
                    program,
                    own_graph=graph,
                    background_graph=materials.graphs[0],
                    graph_bits=materials.bits(graph),
                    tile_graphs=frame[TILE_GRAPHS],
                )
            draw_tiles(frame, framebuffer, program)

    def programs(
        self, frame: Frame, materials: MaterialBuffers, constants: dict[str, Any]
    ) -> dict[int, moderngl.Program]:
        """The program of each graph; -1 stands for none. Graphs that the driver cannot compile are left out."""
        programs: dict[int, moderngl.Program] = {}
        for graph in materials.graphs:
            shader = materials.shader(graph)
            try:
                programs[graph] = self.tile_program(*RECORDS, *shader.includes, **constants, **shader.constants)
            except ShaderError as error:
                if graph < 0:
                    raise
                count = materials.leave_out(graph)
                issue = f"The graphics driver cannot compile the nodes of {count} materials, which have one colour"
                frame.warnings.add(f"{issue}: {error}")
                return self.programs(frame, materials, constants)
        return programs
