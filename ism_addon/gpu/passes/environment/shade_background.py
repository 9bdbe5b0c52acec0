# SPDX-License-Identifier: GPL-3.0-or-later
"""What the camera sees of a world whose radiance a graph gives. One of even radiance takes no pass."""

from typing import Any

from ....resources import BACKGROUND_DEPTH, DEPTH, MATERIAL_BUFFERS, TILES
from ....resources.world import BACKGROUND
from ....scene import Change
from ...buffers.texture_buffer import image_constants
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl.shader_compiler import ShaderError, bind
from ...gl.shader_records import IMAGE
from ...materials.shader import glsl


class ShadeBackground(Pass):
    """Radiance of the world at the pixels that show no surface, W/(sr m²)."""

    inputs = DEPTH, MATERIAL_BUFFERS, TILES, Change.WORLD, Change.VIEW
    outputs = outputs(BACKGROUND)

    def needed(self, frame: Frame) -> bool:
        return bool(frame.scene.world.graph[1] >= 0) and not frame.view.transparent

    def execute(self, frame: Frame) -> None:
        world, texels = frame.scene.world, frame[MATERIAL_BUFFERS].texels
        graph = frame.scene.graphs[world.graph[1]]
        reads_images, constants = graph.uses("image"), dict[str, Any](background_depth=BACKGROUND_DEPTH)
        if reads_images:
            constants |= image_constants(frame.scene.images)
        framebuffer = frame.framebuffer(BACKGROUND)
        try:
            program = self.tile_program(IMAGE, glsl(graph), **constants)
        except ShaderError as error:
            issue = "The graphics driver cannot compile the nodes of the world, which has one color"
            frame.warnings.add(f"{issue}: {error}")
            framebuffer.clear(*world.background.tolist())
            return
        self.device.overwrite()
        bind(
            program,
            depth=frame[DEPTH],
            first_constant=int(world.first_constant[1]),
            graph_constants=self.device.buffer_from(world.constants),
            **(texels.samplers if reads_images else {}),
        )
        draw_tiles(frame, framebuffer, program)
