# SPDX-License-Identifier: GPL-3.0-or-later
"""Radiance of each light towards the camera: a prediction, and its correction by shadow rays.

With U the unshadowed radiance and p the predicted visibility, p U is the prediction. A ray to a sample of the light has
the visibility v, 0 or 1, and estimates U by x. The residual x (v - p) corrects the prediction, which is a control
variate: the sum is unbiased, and the residual is 0 where v = p. This is the ratio estimator of Heitz, Hill & McGuire
2018 in a form whose samples can be summed. The number of rays in a sample, often a probability, is proportional to how
much a ray can change the picture, and its inverse is their weight. Where the prediction is certain, a few rays only
test it. Where U is not exact, the residual is x v - p U, and only darkness is certain. Where only falloff makes it so,
the residual is that of one distance, see trace/ray_correction.glsl. Faint lights have one prediction per tile, see
faint_lights.py.
"""

from typing import Any

import moderngl
import numpy as np

from ....resources import (
    CACHE_CONSTANTS,
    CONTRIBUTING_LIGHTS,
    FAINT_LIGHTS,
    IRRADIANCE_CACHE,
    LIGHT_BUFFERS,
    LIGHT_INFLUENCE,
    LIGHTS_USED,
    MEAN_LUMINANCE,
    POINT_GRAPHS,
    PREDICTED_PIXEL,
    PREDICTED_VISIBILITY,
    PREDICTION,
    RAY_COUNT,
    RAY_COUNTS,
    TILE_SIZE,
    TILE_VISIBILITY,
    TILES,
    TLAS,
)
from ....resources.world import PORTALS
from ....scene import Change
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl import driver_variants
from ...gl.context import Device
from ...gl.render_targets import create, create_neutral
from ...gl.shader_compiler import bind
from ...lights import shader_variant, type_of
from ...lights.modulation import mean_points
from ...material_inputs import MATERIAL, material_constants, material_samplers
from ...materials.point_graphs import NO_POINT_GRAPHS, OPAQUE, PointGraphs
from ...occlusion import DIRECT, SEPARATE_WORLD, separates_world, targets_of
from ...surface_inputs import SURFACE, surface_samplers
from ..light_selection.scene_portals import portals_of
from .faint_lights import ESTIMATE_NODES, drawn_pairs
from .ray_correction import (
    RECORDS,
    light_shift,
    light_steps,
    lobe_sequence,
    lobe_shift,
    ray_sequence,
    ray_threshold,
    shader_constants,
)
from .tiles_of_lights import TilesOfLights, casts_shadow

# How these were chosen: `dev.py bench constants`, see docs/benchmarks.md.

#: Minimum probability of a ray that corrects a prediction, and of a ray to a faint light.
MIN_RAY_PROBABILITY = 0.1
MIN_FAINT_RAY_PROBABILITY = 0.05


class TraceShadows(Pass):
    """Predicted radiance W/(sr m²), and the residuals that correct it."""

    inputs = (
        *(*SURFACE, *MATERIAL, TILES, LIGHT_BUFFERS, TLAS, LIGHT_INFLUENCE),
        *(POINT_GRAPHS, PORTALS, CONTRIBUTING_LIGHTS, IRRADIANCE_CACHE, FAINT_LIGHTS, TILE_VISIBILITY),
        *(PREDICTED_VISIBILITY, PREDICTED_PIXEL, MEAN_LUMINANCE, Change.LIGHTS, Change.SAMPLE, "shadow.enabled"),
        "ssao.light",
    )
    outputs = outputs(*DIRECT, *SEPARATE_WORLD, RAY_COUNTS, LIGHTS_USED)

    def __init__(self, device: Device):
        super().__init__(device)
        self.all_visible = create_neutral(device.gl, PREDICTION)
        self.framebuffers: dict[int, moderngl.Framebuffer] = {}

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0

    def execute(self, frame: Frame) -> None:
        frame[RAY_COUNTS] = self.ray_counts(frame)
        for target in SEPARATE_WORLD if separates_world(frame) else ():
            frame.allocate(target, frame.size)
        for targets in (DIRECT, SEPARATE_WORLD) if separates_world(frame) else (DIRECT,):
            frame.framebuffer(*targets).clear()
        self.device.add()
        used = self.draw_lights(frame) | self.draw_faint_lights(frame)
        frame[LIGHTS_USED] = frozenset(used)
        frame.counts["lights_used"] = max(frame.counts["lights_used"], len(used))

    def ray_counts(self, frame: Frame) -> dict[int, moderngl.Texture]:
        """By light, the RAY_COUNT textures of lights that rays are traced to. Cleared before the first rays."""
        previous, texture_size = frame.get(RAY_COUNTS) or {}, driver_variants.sides(frame.size)
        if not frame.corrects:
            return previous
        counts = {}
        for light in frame[TILE_VISIBILITY] if frame.casts_shadows else ():
            fits = light in previous and previous[light].size == texture_size
            counts[light] = previous[light] if fits else create(self.device.gl, RAY_COUNT, frame.size)
            if not fits or frame.sample == 0:
                self.device.gl.framebuffer([counts[light]]).clear()
        return counts

    def draw_lights(self, frame: Frame) -> set[int]:
        """Draw lights that have a prediction at each pixel. Returns those that were drawn in any tile."""
        # In the first picture, reflections are as predicted, without noise.
        correct = int(frame.scene.has_gloss and frame.corrects)
        traced_draws, used = [], set()
        surfaces, programs, tiles = self.surfaces(frame), set[moderngl.Program](), TilesOfLights(frame)
        shared, caches = self.shared_uniforms(frame), frame.get(IRRADIANCE_CACHE) or {}

        def bind_light(program: moderngl.Program, occluders: PointGraphs, **uniforms: Any) -> None:
            """Bind the uniforms of a light, and once those that all lights share."""
            bind(program, **uniforms, **({} if program in programs else shared | occluders.uniforms))
            programs.add(program)

        # All draws to one framebuffer come first, as changing it takes time.
        for light in frame[CONTRIBUTING_LIGHTS]:
            variant = self.variant(frame, light)
            exact = variant["exact"] == 1
            traced, untraced = tiles.of_light(light, exact & caches[light].exact if light in caches else exact)
            if not len(traced) + len(untraced):
                continue
            used.add(light)
            uniforms = self.uniforms(frame, light)
            is_round = type_of(frame.scene.lights, light).is_round(frame.scene.lights, light)
            sequences = {"light_uv_shift": light_shift(light), **ray_sequence(is_round)}
            if frame.scene.has_gloss:
                sequences |= {"lobe_shift": lobe_shift(light), **lobe_sequence()}
            if len(untraced):
                occluders = surfaces if variant["hard"] else OPAQUE
                program = self.prediction_program(variant, correct, occluders)
                bind_light(program, occluders, **uniforms, **(sequences if correct else {}))
                draw_tiles(frame, frame.framebuffer(*targets_of(frame, light)[: 1 + correct]), program, untraced)
            frame.counts["pairs_traced"] += len(traced) * TILE_SIZE**2
            if len(traced):
                if portals := portals_of(frame, light):
                    variant = variant | portals.constants | {"exact_but_for_falloff": 0}
                    uniforms = uniforms | portals.uniforms
                traced_draws.append((light, variant, uniforms | sequences, traced))
        threshold = ray_threshold(frame) if traced_draws else 0.0
        for light, variant, uniforms, traced in traced_draws:
            constants = shader_constants(variant, 1, correct, len(frame.grid.subpixel_offsets), MIN_RAY_PROBABILITY)
            program = self.tile_program(*RECORDS, *surfaces.parts, **constants, **surfaces.constants)
            bind_light(program, surfaces, **uniforms, ray_threshold=threshold)
            draw_tiles(frame, self.framebuffer(frame, light), program, traced, rays=variant["max_rays"])
        return used

    def prediction_program(self, variant: dict[str, Any], correct: int, occluders: PointGraphs) -> moderngl.Program:
        """The program that draws predictions without rays."""
        constants = shader_constants(variant, 0, correct, 1, MIN_RAY_PROBABILITY)
        return self.tile_program(*RECORDS, *occluders.parts, **constants, **occluders.constants)

    @staticmethod
    def surfaces(frame: Frame) -> PointGraphs:
        """What shadow rays pass."""
        return (frame.get(POINT_GRAPHS) or NO_POINT_GRAPHS).shadow

    @staticmethod
    def variant(frame: Frame, light: int, is_faint: bool = False) -> dict[str, Any]:
        """Constants of a light's shader. Faint ones are not in the irradiance cache, and have predictions if hard."""
        lights = frame.scene.lights
        cache = None if is_faint else (frame.get(IRRADIANCE_CACHE) or {}).get(light)
        light_type, variant = type_of(lights, light), shader_variant(lights, light, cache is not None)
        hard = not is_faint and casts_shadow(frame, light) and variant["exact"] and light_type.is_hard(lights, light)
        if is_faint and variant["meshes_with_bvh"]:
            variant = variant | {"estimate_nodes": ESTIMATE_NODES}
        cached = {"hard": int(hard), "cached": cache.variant if cache else 0} | CACHE_CONSTANTS
        return variant | cached | material_constants(frame)

    @staticmethod
    def shared_uniforms(frame: Frame) -> dict[str, Any]:
        """Uniforms of all lights' predictions."""
        return {
            **surface_samplers(frame),
            **material_samplers(frame),
            **frame[LIGHT_BUFFERS],
            **mean_points(frame.sample),
            "predicted_pixels": frame[PREDICTED_PIXEL],
            **(frame[TLAS] if frame.casts_shadows else {}),
        }

    def uniforms(self, frame: Frame, light: int) -> dict[str, Any]:
        """Uniforms of a light's prediction."""
        cache = frame.get(IRRADIANCE_CACHE) or {}
        return {
            "prediction": frame[PREDICTED_VISIBILITY][light] if casts_shadow(frame, light) else self.all_visible,
            **(cache[light].uniforms if light in cache else {}),
        }

    def framebuffer(self, frame: Frame, light: int) -> moderngl.Framebuffer:
        """Framebuffer for the rays to a light, cached while its textures are the same."""
        prediction, residual = targets_of(frame, light)
        textures = frame[prediction], frame[residual], frame[RAY_COUNTS][light]
        cached = self.framebuffers.get(light)
        if cached is None or cached.color_attachments != textures:
            for unused in self.framebuffers.keys() - frame[RAY_COUNTS].keys():
                del self.framebuffers[unused]
            self.framebuffers[light] = self.device.gl.framebuffer(textures)
        return self.framebuffers[light]

    def draw_faint_lights(self, frame: Frame) -> set[int]:
        """Draw faint lights, with one draw for each shader variant. Returns those that were drawn in any tile."""
        tiles = self.faint_tiles(frame)
        lights: list[int] = np.unique(tiles["light"]).tolist()
        variants = {light: self.variant(frame, light, is_faint=True) for light in lights}
        draws: dict[tuple[Any, ...], list[int]] = {}
        for light, variant in variants.items():
            draws.setdefault((targets_of(frame, light), *variant.items()), []).append(light)
        for (targets, *_), drawn in draws.items():
            variant, variant_tiles = variants[drawn[0]], tiles[np.isin(tiles["light"], drawn)]
            if not frame.corrects:  # by the programs of other lights, as a first picture waits for all programs
                program, target = self.prediction_program(variant, 0, OPAQUE), frame.framebuffer(targets[0])
                bind(program, **self.shared_uniforms(frame), prediction=self.all_visible)
            else:
                target = frame.framebuffer(*targets)
                program = self.faint_program(frame, variant)
                frame.counts["pairs_traced"] += frame.casts_shadows * len(variant_tiles) * TILE_SIZE**2
            draw_tiles(frame, target, program, variant_tiles)
        return set(lights)

    def faint_program(self, frame: Frame, variant: dict[str, Any]) -> moderngl.Program:
        """The program that draws faint lights of a variant after the first picture, with its uniforms."""
        rays, correct = int(frame.casts_shadows), int(frame.scene.has_gloss)
        surfaces, offsets = self.surfaces(frame) if rays else OPAQUE, len(frame.grid.subpixel_offsets)
        constants = shader_constants(variant, rays, correct, offsets, MIN_FAINT_RAY_PROBABILITY)
        program = self.tile_program(*RECORDS, *surfaces.parts, suffix="faint", **constants, **surfaces.constants)
        bind(
            program,
            **surface_samplers(frame) | material_samplers(frame),
            **frame[LIGHT_BUFFERS],
            **mean_points(frame.sample),
            light_steps=light_steps(),
            **ray_sequence(),
            **(lobe_sequence() if correct else {}),
            ray_threshold=ray_threshold(frame) if rays else 0.0,
            **(frame[TLAS] | surfaces.uniforms if rays else {}),
        )
        return program

    def faint_tiles(self, frame: Frame) -> np.ndarray:
        """Rows of TILE: pairs of a tile and a faint light that this sample draws."""
        if not len(frame[FAINT_LIGHTS]):
            return frame[TILES][:0]
        return drawn_pairs(frame[FAINT_LIGHTS], frame[TILES], *frame.tiles, frame.sample)
