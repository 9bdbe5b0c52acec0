# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws tiles, all pixels, or a texel for each tile, split into draws within draw_limit."""

from typing import Any

import moderngl
import numpy as np

from ..resources import TILE_SIZE, TILES
from .frame import Frame
from .gl.draw_limit import TEXELS_PER_RAY, portions, rectangles
from .gl.render_targets import draw_into
from .gl.shader_compiler import bind
from .tiles import TILE_LAYOUT

#: Columns of the picture of evaluate_points, so that it is within OpenGL's limits.
COLUMNS = 1024


def draw_tiles(
    frame: Frame,
    target: moderngl.Framebuffer,
    program: moderngl.Program,
    tiles: np.ndarray | None = None,
    margin: int = 0,
    side: int = TILE_SIZE,
    rays: float = 1.0,
    border: int = 0,
    counts: tuple[int, int] | None = None,
) -> None:
    """Draw `tiles`, rows of TILE, or all tiles that take part in this sample, with `margin` px around each.

    In this target, a tile has `side`×`side` pixels, and around the picture are `border` px, at most a tile. A pixel
    takes the time of `rays` rays, see draw_limit. `counts`: columns and rows, if they are not those of the picture.
    """
    tiles = frame[TILES] if tiles is None else tiles
    if not len(tiles):
        return
    columns, rows = counts or frame.tiles
    corner = 0
    if border:  # a viewport with one more tile on each side: drivers may clip points to it
        columns, rows, corner, tiles = columns + 2, rows + 2, border - side, tiles.copy()
        tiles["tile"] += 1
    tile_viewport = corner, corner, columns * side, rows * side
    draw_into(target)
    viewport = target.viewport
    if viewport != tile_viewport:
        target.viewport = tile_viewport
    frame.device.gl.enable(moderngl.PROGRAM_POINT_SIZE)
    size = side + 2 * margin
    bind(program, tile_counts=(columns, rows), size=float(size))
    try:
        for portion in portions(len(tiles), rays * size * size):
            frame.submission.before_draw(rays * size * size * (portion.stop - portion.start))
            frame.device.points.draw(program, tiles[portion], TILE_LAYOUT)
    finally:
        if viewport != tile_viewport:
            target.viewport = viewport


def draw_per_tile(frame: Frame, target: moderngl.Framebuffer, shader: moderngl.VertexArray, **uniforms: Any) -> None:
    """Draw a target with a texel for each tile, in strips, by a shader that includes tile_index.glsl."""
    bind(shader.program, columns=frame.tiles[0], strip=target.viewport[2], **uniforms)
    draw_pixels(frame, target, shader, 2 * TILE_SIZE**2 / TEXELS_PER_RAY)  # about the time to fetch from two images


def draw_pixels(frame: Frame, target: moderngl.Framebuffer, shader: moderngl.VertexArray, rays: float = 1.0) -> None:
    """Draw all pixels of a target's viewport by a full-screen triangle. A pixel takes the time of `rays` rays."""
    draw_into(target)
    left, bottom, *size = target.viewport
    try:
        for x, y, width, height in rectangles((size[0], size[1]), rays):
            frame.submission.before_draw(rays * width * height)
            if [width, height] != size:
                target.scissor = left + x, bottom + y, width, height
            shader.render(moderngl.TRIANGLES, vertices=3)
    finally:
        if [width, height] != size:
            target.scissor = None  # type: ignore[assignment] # None resets it


def evaluate_points(
    frame: Frame, shader: moderngl.VertexArray, points: np.ndarray, components: int, **uniforms: Any
) -> np.ndarray:
    """(P,components) float32: what a shader of full_screen_program gives at points (P,8) uint32, two texels each."""
    device, rows = frame.device, -(-len(points) // COLUMNS)
    table = np.zeros((rows * COLUMNS, 8), np.uint32)
    table[: len(points)] = points
    texture = device.gl.texture((COLUMNS, rows), components, dtype="f4")
    device.overwrite()
    bind(shader.program, points=device.buffer_from(table.reshape(-1, 4)), columns=COLUMNS, **uniforms)
    draw_pixels(frame, device.gl.framebuffer([texture]), shader)
    return np.frombuffer(texture.read(), np.float32).reshape(-1, components)[: len(points)]
