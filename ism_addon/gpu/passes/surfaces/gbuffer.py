# SPDX-License-Identifier: GPL-3.0-or-later
"""The visible surfaces: depth, position, normals and base color, fetched from the visibility buffer's triangles.

Beck-Norén & Valter 2013, section 3.3, also store depth, normals and positions.
"""

from functools import cached_property
from typing import Any, ClassVar

import moderngl

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
    TLAS,
    UV_BUFFERS,
    VISIBILITY_BUFFER,
)
from ....sampling.dimensions import Dimension, draw, fixed_increments, fixed_point
from ....scene import Change, Scene
from ...buffers.corner_buffers import attribute_uniforms
from ...buffers.material_buffers import MaterialBuffers
from ...drawing import draw_tiles
from ...frame import Frame, Input, Pass, outputs
from ...gl import shader_records
from ...gl.buffer_texture import BufferTexture
from ...gl.shader_compiler import ProgramSource, ShaderError, bind, program_of
from ...gl.shader_records import CASTER, INSTANCE, MEMBERSHIP, OBJECT_INFO, Record
from ...material_inputs import GLOSS, MATERIAL, layer_targets, lobe_targets
from ...materials import lobe_tables
from ...materials.shader import MaterialShader
from ...surface_inputs import visible_triangle_uniforms

#: Records that the shader fetches.
RECORDS: tuple[Record, ...] = INSTANCE, OBJECT_INFO, shader_records.MATERIAL, shader_records.IMAGE


class GBuffer(Pass):
    """Depth along the view's axis, position, normals and base color of each pixel's nearest surface."""

    inputs: ClassVar[tuple[Input, ...]] = (
        *(VISIBILITY_BUFFER, MESH_BUFFERS, INSTANCE_BUFFERS, MATERIAL_BUFFERS, UV_BUFFERS, ATTRIBUTE_BUFFERS, TILES),
        *(TILE_GRAPHS, Change.NORMALS, Change.VIEW, Change.SAMPLE, "shortcuts"),
    )
    outputs = outputs(DEPTH, POSITION, NORMAL, PRIMITIVE, TERMINATOR_OFFSET) | dict.fromkeys(
        MATERIAL, (MATERIAL_BUFFERS,)
    )

    @cached_property
    def lobe_tables(self) -> BufferTexture:
        return self.device.buffer_from(lobe_tables.texture_rows())

    def execute(self, frame: Frame) -> None:
        frame.device.overwrite()
        scene, materials, targets = (
            frame.scene,
            frame[MATERIAL_BUFFERS],
            (DEPTH, POSITION, NORMAL, BASE_COLOR),
        )
        for target in lobe_targets(scene):
            frame.allocate(target, frame.size)
        framebuffer = frame.framebuffer(*targets, *(GLOSS if scene.has_gloss else ()))
        for graph, program in self.programs(frame, materials).items():
            self.draw(frame, framebuffer, program, materials, graph)
        if layers := layer_targets(scene):
            framebuffer = frame.framebuffer(*layers)
            draw_tiles(frame, framebuffer, program_of(self.device, empty_layers(scene)))
            for graph in materials.graphs:
                if materials.shader(graph).has_layers:
                    program = program_of(self.device, layers_source(scene, materials.shader(graph)))
                    self.draw(frame, framebuffer, program, materials, graph)

    def draw(
        self,
        frame: Frame,
        framebuffer: moderngl.Framebuffer,
        program: moderngl.Program,
        materials: MaterialBuffers,
        graph: int,
    ) -> None:
        """Draw the materials of a graph."""
        shader = materials.shader(graph)
        bind(
            program,
            **visible_triangle_uniforms(frame),
            instances=frame[INSTANCE_BUFFERS].table,
            materials=materials.table,
            **materials.samplers(shader),
            **frame[MESH_BUFFERS].samplers,
            **({"uvs": frame[UV_BUFFERS].texture} if shader.reads_uvs else {}),
            **({"object_info": frame[INSTANCE_BUFFERS].info} if shader.reads_objects else {}),
            **(frame[INSTANCE_BUFFERS].attributes if shader.reads_instance_attributes else {}),
            **({"lobe_tables": self.lobe_tables} if shader.has_gloss else {}),
            **(attribute_uniforms(frame[ATTRIBUTE_BUFFERS]) if shader.reads_attributes else {}),
            **(self.ray_uniforms(frame) if shader.traces_rays else {}),
        )
        if "graph_cells" in shader.constants:
            bind(
                program,
                own_graph=graph,
                background_graph=materials.graphs[0],
                graph_bits=materials.bits(graph),
                tile_graphs=frame[TILE_GRAPHS],
            )
        draw_tiles(frame, framebuffer, program)

    def ray_uniforms(self, frame: Frame) -> dict[str, Any]:
        """Uniforms of materials whose graphs trace rays."""
        return {}

    def programs(self, frame: Frame, materials: MaterialBuffers) -> dict[int, moderngl.Program]:
        """The program of each graph; -1 stands for none. Graphs that the driver cannot compile are left out."""
        programs: dict[int, moderngl.Program] = {}
        for graph in materials.graphs:
            try:
                shader = materials.shader(graph)
                programs[graph], *_ = [program_of(self.device, each) for each in sources(frame.scene, shader)]
            except ShaderError as error:
                if graph < 0:
                    raise
                count = materials.leave_out(graph)
                issue = f"The graphics driver cannot compile the nodes of {count} materials, which have one colour"
                frame.warnings.add(f"{issue}: {error}")
                return self.programs(frame, materials)
        return programs


class TracingGBuffer(GBuffer):
    """The same of scenes with graphs that trace rays, which need acceleration structures before."""

    inputs = *GBuffer.inputs, TLAS

    def ray_uniforms(self, frame: Frame) -> dict[str, Any]:
        return {
            **{name: value for name, value in frame[TLAS].items() if name != "corners"},
            "pixel_steps": fixed_increments(Dimension.NODE_RAY, "pixel"),
            "first_node_ray": fixed_point(draw(Dimension.NODE_RAY, ray=0)),
            "node_ray_steps": fixed_increments(Dimension.NODE_RAY, "ray"),
        }


def records(shader: MaterialShader) -> tuple[Record, ...]:
    """Records that the shader of a graph fetches."""
    return (*RECORDS, CASTER, MEMBERSHIP) if shader.traces_rays else RECORDS


def sources(scene: Scene, shader: MaterialShader) -> list[ProgramSource]:
    """The programs that draw the materials of a shader: of all targets but the layers, then of those it has."""
    base = GBuffer.tile_source(
        *records(shader),
        *shader.includes,
        background_depth=BACKGROUND_DEPTH,
        layers=0,
        gloss=int(scene.has_gloss),
        coat=int(shader.has_coat),
        **shader.constants,
    )
    return [base, layers_source(scene, shader)] if shader.has_layers else [base]


def layers_source(scene: Scene, shader: MaterialShader) -> ProgramSource:
    """The program that draws the layers of a shader's materials."""
    return GBuffer.tile_source(
        *records(shader), *shader.includes, layers=1, **layers_constants(scene), **shader.constants
    )


def empty_layers(scene: Scene) -> ProgramSource:
    """The program that draws what materials without layers have."""
    return GBuffer.tile_source(*RECORDS, layers=1, graph=0, glossy=0, images=0, **layers_constants(scene))


def layers_constants(scene: Scene) -> dict[str, Any]:
    """Constants of programs that draw layer_targets."""
    coat, rare = int(scene.has_coat), int(scene.has_extra)
    return {"gloss": 1, "coat": coat, "rare_lobes": rare, "rare_location": coat, "background_depth": BACKGROUND_DEPTH}
