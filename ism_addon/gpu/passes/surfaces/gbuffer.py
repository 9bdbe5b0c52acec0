# SPDX-License-Identifier: GPL-3.0-or-later
"""The visible surfaces: depth, position, normals and base color, fetched from the visibility buffer's triangles.

Beck-Norén & Valter 2013, section 3.3, also store depth, normals and positions.
"""

from typing import Any

from ....resources import (
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
from ....setting_limits import TEXTURE_WIDTH
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl import shader_records
from ...gl.shader_compiler import bind
from ...gl.shader_records import INSTANCE
from ...material_inputs import MATERIAL


class GBuffer(Pass):
    """Depth along the view's axis, position, normals and base color of each pixel's nearest surface."""

    inputs = (
        *(VISIBILITY_BUFFER, MESH_BUFFERS, INSTANCE_BUFFERS, MATERIAL_BUFFERS, UV_BUFFERS, TILES),
        *(Change.VIEW, Change.SAMPLE, "shortcuts"),
    )
    outputs = outputs(PRIMITIVE, DEPTH, POSITION, NORMAL, TERMINATOR_OFFSET) | dict.fromkeys(
        MATERIAL, (MATERIAL_BUFFERS,)
    )

    def execute(self, frame: Frame) -> None:
        frame.device.overwrite()
        first, size = frame.grid.bounds(*frame.size)
        # A variant without images: some drivers execute both branches.
        images = len(frame.scene.images) > 0
        materials, targets = frame[MATERIAL_BUFFERS], (DEPTH, POSITION, NORMAL, BASE_COLOR, PRIMITIVE)
        constants: dict[str, Any] = {
            "background_depth": BACKGROUND_DEPTH,
            **({"images": 1, "width": TEXTURE_WIDTH, **materials.texels.constants} if images else {"images": 0}),
            **{f"{target.name}_location": location for location, target in enumerate(MATERIAL_VALUES, len(targets))},
        }
        program = self.tile_program(INSTANCE, shader_records.MATERIAL, **constants)
        bind(
            program,
            visibility_buffer=frame[VISIBILITY_BUFFER],
            fine_from_pixel=tuple(frame.grid.fine_from_pixel.T.ravel()),
            first=tuple(first),
            last=tuple(size - 1),
            instances=frame[INSTANCE_BUFFERS].table,
            materials=materials.table,
            **materials.texels.samplers,
            **frame[MESH_BUFFERS].samplers,
            **({"uvs": frame[UV_BUFFERS].uvs.texture} if images else {}),
        )
        draw_tiles(frame, frame.framebuffer(*targets, *MATERIAL_VALUES), program)
