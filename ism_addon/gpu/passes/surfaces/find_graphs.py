# SPDX-License-Identifier: GPL-3.0-or-later
"""Which graphs each tile shows, so that the program of a graph draws only those tiles."""

from ....resources import (
    GRAPH_CELLS,
    MATERIAL_BUFFERS,
    MESH_BUFFERS,
    TILE_GRAPHS,
    TILE_SIZE,
    TILES,
    VISIBILITY_BUFFER,
)
from ....scene import Change
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl import shader_records
from ...gl.shader_compiler import bind
from ...materials.shader import has_several_graphs
from ...surface_inputs import visible_triangle_uniforms


class FindGraphs(Pass):
    """A bit for each graph that the pixels of a tile have."""

    inputs = VISIBILITY_BUFFER, MESH_BUFFERS, MATERIAL_BUFFERS, TILES, Change.VIEW, Change.SAMPLE
    outputs = outputs(TILE_GRAPHS)

    def needed(self, frame: Frame) -> bool:
        return has_several_graphs(frame.scene.materials, frame.scene.graphs)

    def execute(self, frame: Frame) -> None:
        frame.device.overwrite()
        program = self.tile_program(shader_records.MATERIAL, cell_size=TILE_SIZE // GRAPH_CELLS)
        materials = frame[MATERIAL_BUFFERS]
        bind(
            program,
            materials=materials.table,
            background_graph=materials.graphs[0],
            corners=frame[MESH_BUFFERS].samplers["corners"],
            **visible_triangle_uniforms(frame),
        )
        draw_tiles(frame, frame.framebuffer(TILE_GRAPHS), program, side=GRAPH_CELLS)
