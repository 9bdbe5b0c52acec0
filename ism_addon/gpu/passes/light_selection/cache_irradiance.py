# SPDX-License-Identifier: GPL-3.0-or-later
"""Irradiance cache (Ward, Rubinstein & Clear 1988) of lights with a light BVH: their irradiance is dear to compute.

At each pixel it is estimated from one node. The cache has the ratio of the irradiance to this estimate at one pixel of
every CACHE_SPACING × CACHE_SPACING: it is near 1 and varies little, so interpolating it adds almost no error.
"""

from typing import Any

import moderngl
import numpy as np

from ....resources import (
    CACHE_SPACING,
    IRRADIANCE_CACHE,
    IRRADIANCE_RATIO,
    LIGHT_BUFFERS,
    LIGHT_INFLUENCE,
    NORMAL,
    POSITION,
    TILE_SIZE,
)
from ....scene import Change
from ...drawing import draw_pixels
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.render_targets import create, size_of
from ...gl.shader_compiler import bind
from ...gl.shader_records import LIGHT_RECORDS
from ...lights import has_light_bvh, shader_variant

#: Time of a texel, in rays: measured with a ball of 960 triangles, from close by.
RAYS_PER_TEXEL = 16.0


#: Where there is no surface, or the light is culled or faint.
NO_RATIO = -1.0


class CacheIrradiance(Pass):
    """For each light with a light BVH that is visible, the ratio of its irradiance to the estimate."""

    schedule = Schedule.DOUBLING  # for lights that were believed occluded before
    inputs = POSITION, NORMAL, LIGHT_BUFFERS, LIGHT_INFLUENCE, Change.LIGHTS, Change.SAMPLE
    outputs = outputs(IRRADIANCE_CACHE)

    def needed(self, frame: Frame) -> bool:
        return bool(has_light_bvh(frame.scene.lights).any())

    def execute(self, frame: Frame) -> None:
        lights, gl = frame.scene.lights, self.device.gl
        ratios: dict[int, moderngl.Texture] = {} if frame.sample == 0 else dict(frame[IRRADIANCE_CACHE])
        gl.enable_only(moderngl.NOTHING)
        has_bvh = has_light_bvh(lights)
        for light, influence in frame[LIGHT_INFLUENCE].items():
            tiles = influence.contributes & ~influence.is_faint
            visible = tiles & (influence.coarse_visibility > 0.0)
            if light in ratios or not has_bvh[light] or not visible.any():
                continue
            variant: dict[str, Any] = shader_variant(lights, light)
            constants: dict[str, Any] = {"cache_spacing": CACHE_SPACING, "tile_size": TILE_SIZE, "no_ratio": NO_RATIO}
            shader = self.full_screen_program(*LIGHT_RECORDS, **constants, **variant)
            needed = gl.texture(frame.tiles, 1, near_tiles(tiles).astype(np.uint8) * 255, alignment=1)
            surfaces = {"position": frame[POSITION], "normal": frame[NORMAL], "needed": needed}
            bind(shader.program, **surfaces, **frame[LIGHT_BUFFERS], light_index=light)
            width, height = size_of(IRRADIANCE_RATIO, *frame.size)
            ratios[light] = create(gl, IRRADIANCE_RATIO, (width + 1, height + 1))  # to interpolate to the last pixels
            draw_pixels(frame, gl.framebuffer([ratios[light]]), shader, RAYS_PER_TEXEL)
        frame[IRRADIANCE_CACHE] = ratios


def near_tiles(tiles: np.ndarray) -> np.ndarray:
    """(rows,columns) bool: tiles (rows,columns), and those after them, whose first pixels they interpolate with."""
    near = tiles.copy()
    near[1:] |= tiles[:-1]
    near[:, 1:] |= near[:, :-1].copy()
    return near
