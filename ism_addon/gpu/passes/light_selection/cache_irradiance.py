# SPDX-License-Identifier: GPL-3.0-or-later
"""Irradiance cache (Ward, Rubinstein & Clear 1988) of lights with a light BVH: their irradiance is dear to compute.

At each pixel it is estimated from few nodes. The cache has the ratio of the irradiance to this estimate at one pixel of
every CACHE_SPACING × CACHE_SPACING: it is near 1 and varies little, so interpolating it adds almost no error.
"""

from typing import Any

import moderngl

from ....resources import (
    CACHE_SPACING,
    IRRADIANCE_CACHE,
    IRRADIANCE_RATIO,
    LIGHT_BUFFERS,
    LIGHT_INFLUENCE,
    NORMAL,
    POSITION,
)
from ....scene import Change
from ...drawing import draw_pixels
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.render_targets import create, size_of
from ...gl.shader_compiler import bind
from ...gl.shader_records import LIGHT_RECORDS
from ...lights import has_light_bvh, shader_variant

#: Time of a texel, in rays.
RAYS_PER_TEXEL = 16.0


class CacheIrradiance(Pass):
    """For each light with a light BVH, the ratio of its irradiance to the estimate."""

    schedule = Schedule.FIRST
    inputs = POSITION, NORMAL, LIGHT_BUFFERS, LIGHT_INFLUENCE, Change.LIGHTS, Change.SAMPLE
    outputs = outputs(IRRADIANCE_CACHE)

    def needed(self, frame: Frame) -> bool:
        return bool(has_light_bvh(frame.scene.lights).any())

    def execute(self, frame: Frame) -> None:
        lights, gl, ratios = frame.scene.lights, self.device.gl, {}
        gl.enable_only(moderngl.NOTHING)
        has_bvh = has_light_bvh(lights)
        for light, influence in frame[LIGHT_INFLUENCE].items():
            if not has_bvh[light] or not (influence.contributes & ~influence.is_faint).any():
                continue
            ratios[light] = create(gl, IRRADIANCE_RATIO, size_of(IRRADIANCE_RATIO, *frame.size))
            variant: dict[str, Any] = shader_variant(lights, light)
            shader = self.full_screen_program(*LIGHT_RECORDS, cache_spacing=CACHE_SPACING, **variant)
            surfaces = {"position": frame[POSITION], "normal": frame[NORMAL]}
            bind(shader.program, **surfaces, **frame[LIGHT_BUFFERS], light_index=light)
            draw_pixels(frame, gl.framebuffer([ratios[light]]), shader, RAYS_PER_TEXEL)
        frame[IRRADIANCE_CACHE] = ratios
