# SPDX-License-Identifier: GPL-3.0-or-later
"""Radiance of each pixel, with shadows from the maps of all virtual lights.

Beck-Norén & Valter 2013, section 3.2. What differs: a light's unshadowed radiance is computed in closed form (see
gpu/lights), and virtual lights only estimate which fraction of it is visible (a ratio estimator, Heitz, Hill & McGuire
2018): without occluders there is no error. The receiver's depth is that of its plane in the direction of the texel's
centre, like the depth of discs, so that a plane does not shadow itself. Matrices come from a table, so their number has
no limit.
"""

from collections.abc import Sequence
from functools import cached_property
from itertools import groupby
from typing import Any

import moderngl

from ....resource_types import Target
from ....resources import (
    ATLAS_BATCH,
    CACHE_CONSTANTS,
    DIRECT_PREDICTION,
    INSTANCE_BUFFERS,
    IRRADIANCE_CACHE,
    LIGHT_BUFFERS,
    NO_OCCLUDER,
    NORMAL,
    POSITION,
    PRIMITIVE,
    SHADOW_MAP_SPLATS,
    SHADOW_MAPS,
    VIRTUAL_LIGHT_COUNTS,
    VIRTUAL_LIGHT_RANGES,
    VIRTUAL_LIGHTS,
)
from ....resources.world import WORLD_PREDICTION
from ....scene import Change
from ...drawing import draw_pixels
from ...frame import Frame, Pass, outputs
from ...gl.shader_compiler import bind
from ...gl.shader_records import LIGHT_RECORDS, MEMBERSHIP, VIRTUAL_LIGHT, VIRTUAL_LIGHT_RANGE
from ...lights import mixed_variant, modulation, type_of
from ...material_inputs import MATERIAL, material_constants, material_samplers
from ...occlusion import separates_world, targets_of

#: Virtual lights, lights or pixels that are evaluated in the time of a ray, see draw_limit.
VIRTUAL_LIGHTS_PER_RAY = 20


class GatherLight(Pass):
    """Radiance W/(sr m²) of each pixel: the sum over the atlases of virtual lights."""

    inputs = (
        *(POSITION, NORMAL, *MATERIAL, PRIMITIVE, INSTANCE_BUFFERS, LIGHT_BUFFERS, VIRTUAL_LIGHT_COUNTS),
        IRRADIANCE_CACHE,
        *(VIRTUAL_LIGHT_RANGES, VIRTUAL_LIGHTS, SHADOW_MAP_SPLATS, SHADOW_MAPS, ATLAS_BATCH, Change.LIGHTS),
        *("shadow.enabled", "shadow.bias", "shadow.fill_holes", "ssao.light"),
    )
    outputs = outputs(DIRECT_PREDICTION, WORLD_PREDICTION)

    @cached_property
    def shaders(self) -> dict[tuple[object, ...], moderngl.VertexArray]:
        """By the constants of the lights it is for, and whether they are in the irradiance cache."""
        return {}

    def shader(self, frame: Frame, drawn: Sequence[int], cached: int) -> moderngl.VertexArray:
        """The shader for the types of these lights. `cached`: the variant of their irradiance cache, or 0."""
        lights = frame.scene.lights
        variant = mixed_variant(lights, drawn) | material_constants(frame)
        key = cached, *variant.items()
        if key not in self.shaders:
            records = *LIGHT_RECORDS, VIRTUAL_LIGHT, MEMBERSHIP, VIRTUAL_LIGHT_RANGE
            parallel = any(type_of(lights, light).parallel for light in drawn)
            constants: dict[str, Any] = {**variant, "parallel": int(parallel), "cached": cached}
            if cached:
                constants |= CACHE_CONSTANTS
            self.shaders[key] = self.full_screen_program(*records, empty=NO_OCCLUDER, **constants)
        return self.shaders[key]

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0

    def execute(self, frame: Frame) -> None:
        counts, batch, shadow = frame[VIRTUAL_LIGHT_COUNTS], frame[ATLAS_BATCH], frame.settings.shadow
        frame.counts["lights_used"] = len(counts)
        if separates_world(frame):
            frame.allocate(WORLD_PREDICTION, frame.size)
        if batch.first == 0:
            for target in (DIRECT_PREDICTION, WORLD_PREDICTION) if separates_world(frame) else (DIRECT_PREDICTION,):
                frame.framebuffer(target).clear()
        if not counts:
            return
        self.device.add()
        cache = frame.get(IRRADIANCE_CACHE) or {}
        uniforms = {
            "position": frame[POSITION],
            "normal": frame[NORMAL],
            **material_samplers(frame),
            "link_groups": frame[INSTANCE_BUFFERS].memberships,
            **frame[LIGHT_BUFFERS],
            **modulation.mean_points(frame.sample),
            "virtual_light_ranges": frame[VIRTUAL_LIGHT_RANGES],
            "virtual_lights": frame[VIRTUAL_LIGHTS],
            "shadow_maps": frame[SHADOW_MAPS if shadow.fill_holes else SHADOW_MAP_SPLATS],
            "batch": (batch.first, batch.count),
            "side": batch.side,
            "columns": batch.columns,
            "shadows": frame.casts_shadows,
            "bias": shadow.bias,
        }

        def drawn_with(indexed: tuple[int, int]) -> tuple[int | None, Target]:
            """Of an index and its light: each light of the cache is drawn alone, with its ratios."""
            return indexed[1] if indexed[1] in cache else None, targets_of(frame, indexed[1])[0]

        for (cached, target), group in groupby(enumerate(counts), drawn_with):
            indices, drawn = zip(*group, strict=True)
            shader = self.shader(frame, drawn, 0 if cached is None else cache[cached].variant)
            ratio = {} if cached is None else cache[cached].uniforms
            bind(shader.program, **uniforms, **ratio, first_light=indices[0], light_count=len(drawn))
            virtual_lights = sum(counts[light] for light in drawn)
            draw_pixels(
                frame, frame.framebuffer(target), shader, (1 + len(drawn) + virtual_lights) / VIRTUAL_LIGHTS_PER_RAY
            )
