# SPDX-License-Identifier: GPL-3.0-or-later
"""What the camera sees: depth, position, normals and base color, fetched from the visibility buffer's triangles.

Beck-Norén & Valter 2013, section 3.3, store depth, normals and positions likewise.
"""

import moderngl

from ....resources import (
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
    TILES,
    UV_BUFFERS,
    VISIBILITY_BUFFER,
)
from ....scene import Change
from ....setting_limits import TEXTURE_WIDTH
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl.shader_compiler import bind
from ...gl.shader_records import INSTANCE, MATERIAL


class GBuffer(Pass):
    """Depth along the view's axis, position, normals and base color of each pixel's nearest surface."""

    inputs = (
        *(VISIBILITY_BUFFER, MESH_BUFFERS, INSTANCE_BUFFERS, MATERIAL_BUFFERS, UV_BUFFERS, TILES),
        *(Change.VIEW, Change.SAMPLE, "shortcuts"),
    )
    outputs = outputs(PRIMITIVE, DEPTH, POSITION, NORMAL, TERMINATOR_OFFSET) | {BASE_COLOR: (MATERIAL_BUFFERS,)}

    def execute(self, frame: Frame) -> None:
        frame.device.gl.enable_only(moderngl.NOTHING)
        first, size = frame.grid.bounds(*frame.size)
        # A variant without images: some drivers execute both branches.
        images = len(frame.scene.images) > 0
        program = self.tile_program(
            INSTANCE, MATERIAL, background_depth=BACKGROUND_DEPTH, images=int(images), width=TEXTURE_WIDTH
        )
        materials = frame[MATERIAL_BUFFERS]
        bind(
            program,
            visibility_buffer=frame[VISIBILITY_BUFFER],
            fine_from_pixel=tuple(frame.grid.fine_from_pixel.T.ravel()),
            first=tuple(first),
            last=tuple(size - 1),
            instances=frame[INSTANCE_BUFFERS].table,
            materials=materials.table,
            texels=materials.texels.texture,
            **frame[MESH_BUFFERS].samplers,
            **({"uvs": frame[UV_BUFFERS].uvs.texture} if images else {}),
        )
        draw_tiles(frame, frame.framebuffer(DEPTH, POSITION, NORMAL, BASE_COLOR, PRIMITIVE), program)
