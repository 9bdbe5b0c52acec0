# SPDX-License-Identifier: GPL-3.0-or-later
"""Probe rays: coarse shadow rays that estimate a light's visibility near a tile or a pixel. One shader traces all.

Each texel of a target stands for a ray. Texels lie in blocks, and all rays of a block go to one light.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np

from ....resources import LIGHT_BUFFERS, POINT_GRAPHS, PROBE, TILE_SIZE, TLAS
from ....sampling.dimensions import fixed_points
from ...drawing import draw_tiles
from ...frame import Frame
from ...gl.buffer_texture import BufferTexture
from ...gl.render_targets import create
from ...gl.shader_compiler import bind, compile_program
from ...gl.shader_records import CASTER, LIGHT_RECORDS, MEMBERSHIP, PROBE_BLOCK
from ...lights import mixed_variant
from ...materials.point_graphs import NO_POINT_GRAPHS
from ...surface_inputs import surface_samplers
from ...tiles import PROBES_PER_TILE_SIDE, tiles_where
from .scene_portals import portals_of

SHADER = "passes/light_selection/probe_rays.frag"
RECORDS = *LIGHT_RECORDS, CASTER, MEMBERSHIP, PROBE_BLOCK

#: Light index of blocks without rays.
NO_LIGHT = -1


def light_blocks(lights: Sequence[int] | np.ndarray, light_uvs: np.ndarray) -> np.ndarray:
    """Rows of PROBE_BLOCK for lights (L,), with light_uvs (L,2) in [0,1). Blocks begin at the picture's first texel."""
    rows = np.zeros(len(light_uvs), PROBE_BLOCK.dtype)
    rows["light"] = lights
    rows["light_uv"] = fixed_points(light_uvs)
    return rows


@dataclass(frozen=True)
class ProbeGrid:
    """The pixels that rays start from, and the layout of the blocks in the target."""

    block_size: tuple[int, int]  # texels
    spacing: int  # px from the first pixel of a texel to that of the next
    pixel_offset: tuple[int, int]  # px from a texel's first pixel to the one that the ray starts from
    light_uv_steps: tuple[int, ...]  # increments of light_uv from texel to texel, in 32-bit fixed point
    block_columns: int = 1  # blocks side by side


def trace_blocks(frame: Frame, rows: np.ndarray, grid: ProbeGrid) -> moderngl.Texture:
    """Trace all blocks of the rows (N,) of PROBE_BLOCK into a PROBE texture."""
    device, lines = frame.device, -(-len(rows) // grid.block_columns)
    table = np.zeros(lines * grid.block_columns, PROBE_BLOCK.dtype)
    table["light"] = NO_LIGHT
    table[: len(rows)] = rows
    lights = frame.scene.lights
    size = grid.block_columns * grid.block_size[0], lines * grid.block_size[1]
    texture = create(device.gl, PROBE, size)
    target = device.gl.framebuffer([texture])
    device.overwrite()
    # In tiles, though all are drawn, so that the program is that of trace_tiles.
    counts = -(-size[0] // TILE_SIZE), -(-size[1] // TILE_SIZE)
    program = ray_program(frame, mixed_variant(lights))
    bind(program, **uniforms(frame, PROBE_BLOCK.upload(device, table), 0, grid))
    draw_tiles(frame, target, program, tiles_where(np.ones(counts[::-1], bool)), counts=counts)
    return texture


def trace_tiles(
    frame: Frame,
    target: moderngl.Framebuffer,
    tiles: np.ndarray,
    light: int,
    blocks: BufferTexture,
    first: int,
    grid: ProbeGrid,
    own_program: bool,
) -> None:
    """Trace the rays of a light in rows of TILE into its PROBE texture. Its block is row `first` of `blocks`.

    `own_program`: by a program for such lights, not for all of the scene. A light with portals has its own.
    """
    portals = portals_of(frame, light)
    variant = mixed_variant(frame.scene.lights, [light] if own_program or portals else None)
    program = ray_program(frame, variant | (portals.constants if portals else {}))
    bind(program, **uniforms(frame, blocks, first, grid), **(portals.uniforms if portals else {}))
    draw_tiles(frame, target, program, tiles, side=PROBES_PER_TILE_SIDE)


def ray_program(frame: Frame, variant: dict[str, int]) -> moderngl.Program:
    """The program for a variant of lights."""
    surfaces = (frame.get(POINT_GRAPHS) or NO_POINT_GRAPHS).shadow
    records, constants = (*RECORDS, *surfaces.records), variant | surfaces.constants
    return compile_program(frame.device, "glsl/tiles.vert", SHADER, *surfaces.includes, records=records, **constants)


def uniforms(frame: Frame, blocks: BufferTexture, first: int, grid: ProbeGrid) -> dict[str, Any]:
    """Uniforms of the shader, which draws the blocks from row `first` on."""
    return {
        **surface_samplers(frame),
        **frame[TLAS],
        **(frame.get(POINT_GRAPHS) or NO_POINT_GRAPHS).shadow.uniforms,
        **frame[LIGHT_BUFFERS],
        "probe_blocks": blocks,
        "first_block": first,
        "block_size": grid.block_size,
        "block_columns": grid.block_columns,
        "spacing": grid.spacing,
        "pixel_offset": grid.pixel_offset,
        "pixel_steps": grid.light_uv_steps,
    }
