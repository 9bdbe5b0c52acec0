# SPDX-License-Identifier: GPL-3.0-or-later
"""Radiance towards the camera by each light: a prediction, and by shadow rays how far that is wrong.

With U the unshadowed radiance, exact, and p the predicted visibility, a ray to a point of the light that alone
estimates U by x corrects p U by x (v - p), v being 1 if it arrives: no error where p is right about a light all visible
or all occluded, none on average elsewhere (a control variate). It is the ratio estimator of Heitz, Hill & McGuire 2018
in another form, whose samples can be added up. The probability of a ray is in proportion to how much it may change the
picture, and its weight is the inverse. Where nothing is uncertain, rare rays only test the prediction. Where U is not
exact, the correction is x v - p U, and all is uncertain. Faint lights are drawn together, with one prediction a tile,
see faint_lights.py.
"""

from typing import Any

import moderngl
import numpy as np

from ....resources import (
    DEPTH,
    DIRECT_PREDICTION,
    DIRECT_RESIDUAL,
    FAINT_LIGHTS,
    LIGHT_BUFFER,
    LIGHT_INFLUENCE,
    LIGHTS_USED,
    MEAN_LUMINANCE,
    PREDICTED_VISIBILITY,
    PREDICTION,
    PREDICTION_SURFACE,
    RAY_COUNT,
    RAY_COUNTS,
    TILE_SIZE,
    TILE_VISIBILITY,
    TILES,
    TLAS,
)
from ....sampling.dimensions import Dimension, draw
from ....scene import Change
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl import driver_variants
from ...gl.context import Device
from ...gl.render_targets import create, create_neutral
from ...gl.shader_compiler import bind
from ...lights import shader_variant, type_of
from ...material_inputs import MATERIAL, material_samplers
from ...surface_inputs import SURFACE, surface_samplers
from .faint_lights import drawn_pairs
from .ray_correction import RECORDS, light_shift, light_steps, ray_sequence, ray_threshold, shader_constants

#: The least probability of a ray; and of one to a faint light.
MIN_RAY_PROBABILITY = 0.1
MIN_FAINT_RAY_PROBABILITY = 0.05

#: The probability that a tile without doubt is tested, for a light that could be as bright there as the picture is on
#: average, and the most: where it is brighter, it is the worse if the prediction is wrong.
CERTAIN_PROBABILITY = 0.03125
MAX_CERTAIN_PROBABILITY = 0.5


class TraceShadows(Pass):
    """Radiance W/(sr m²) as predicted, and what rays add to it or take away."""

    inputs = (
        *(*SURFACE, *MATERIAL, DEPTH, TILES, LIGHT_BUFFER, TLAS, LIGHT_INFLUENCE, FAINT_LIGHTS, TILE_VISIBILITY),
        *(PREDICTED_VISIBILITY, PREDICTION_SURFACE, MEAN_LUMINANCE, Change.LIGHTS, Change.SAMPLE, "shadow.enabled"),
    )
    outputs = outputs(DIRECT_PREDICTION, DIRECT_RESIDUAL, RAY_COUNTS, LIGHTS_USED)

    def __init__(self, device: Device):
        super().__init__(device)
        self.all_visible = create_neutral(device.gl, PREDICTION)
        self.framebuffers: dict[int, moderngl.Framebuffer] = {}

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0

    def execute(self, frame: Frame) -> None:
        gl = self.device.gl
        frame[RAY_COUNTS] = self.ray_counts(frame)
        frame.framebuffer(DIRECT_PREDICTION, DIRECT_RESIDUAL).clear()
        gl.enable_only(moderngl.BLEND)
        gl.blend_func = moderngl.ONE, moderngl.ONE
        used = self.draw_lights(frame) | self.draw_faint_lights(frame)
        frame[LIGHTS_USED] = frozenset(used)
        frame.counts["lights_used"] = max(frame.counts["lights_used"], len(used))

    def ray_counts(self, frame: Frame) -> dict[int, moderngl.Texture]:
        """A RAY_COUNT texture for each light that rays are traced to; without any ray before the second sample."""
        before, room = frame.get(RAY_COUNTS) or {}, driver_variants.sides(frame.size)
        if frame.sample == 0:
            return before
        counts = {}
        for light in frame[TILE_VISIBILITY] if frame.casts_shadows else ():
            fits = light in before and before[light].size == room
            counts[light] = before[light] if fits else create(self.device.gl, RAY_COUNT, frame.size)
            if not fits or frame.sample == 1:
                self.device.gl.framebuffer([counts[light]]).clear()
        return counts

    def draw_lights(self, frame: Frame) -> set[int]:
        """Lights with predictions of their own; gives those that anything was drawn of."""
        predicted, traced_draws, used = frame.framebuffer(DIRECT_PREDICTION), [], set()
        for light in range(len(frame.scene.lights.shape)):  # all of one target first: to change it takes time
            traced, shown = self.chosen(frame, light)
            if not len(traced) + len(shown):
                continue
            used.add(light)
            variant, uniforms = shader_variant(frame.scene.lights, light), self.uniforms(frame, light)
            program = self.tile_program(*RECORDS, **shader_constants(variant, 0, 1, MIN_RAY_PROBABILITY))
            bind(program, **uniforms)
            draw_tiles(frame, predicted, program, shown)
            frame.counts["pairs_traced"] += len(traced) * TILE_SIZE**2
            if len(traced):
                sequences = {"light_uv_shift": light_shift(light), **ray_sequence()}
                traced_draws.append((light, variant, uniforms | sequences, traced))
        for light, variant, uniforms, traced in traced_draws:
            constants = shader_constants(variant, 1, len(frame.grid.places), MIN_RAY_PROBABILITY)
            program = self.tile_program(*RECORDS, **constants)
            bind(program, **uniforms, ray_threshold=ray_threshold(frame), **frame[TLAS])
            draw_tiles(frame, self.framebuffer(frame, light), program, traced)
        return used

    def uniforms(self, frame: Frame, light: int) -> dict[str, Any]:
        """Of a light's prediction."""
        return {
            **surface_samplers(frame),
            **material_samplers(frame),
            "lights": frame[LIGHT_BUFFER],
            "light_index": light,
            "depth": frame[DEPTH],
            "prediction_surface": frame[PREDICTION_SURFACE],
            "prediction": frame[PREDICTED_VISIBILITY][light] if casts_shadow(frame, light) else self.all_visible,
        }

    def framebuffer(self, frame: Frame, light: int) -> moderngl.Framebuffer:
        """Of a light that has rays: the framebuffer that takes what they find, kept as long as its textures are."""
        textures = frame[DIRECT_PREDICTION], frame[DIRECT_RESIDUAL], frame[RAY_COUNTS][light]
        kept = self.framebuffers.get(light)
        if kept is None or kept.color_attachments != textures:
            for gone in self.framebuffers.keys() - frame[RAY_COUNTS].keys():
                del self.framebuffers[gone]
            self.framebuffers[light] = self.device.gl.framebuffer(textures)
        return self.framebuffers[light]

    @staticmethod
    def chosen(frame: Frame, light: int) -> tuple[np.ndarray, np.ndarray]:
        """Tiles where rays are traced, and those where only the prediction is drawn; elsewhere that is nothing."""
        tiles, influence = frame[TILES], frame[LIGHT_INFLUENCE].get(light)
        casts = casts_shadow(frame, light)
        if influence is None or (casts and light not in frame[TILE_VISIBILITY]):
            return tiles[:0], tiles[:0]
        column, row = tiles["tile"].astype(np.int64).T
        own = (influence.contributes & ~influence.is_faint)[row, column]
        tiles, row, column = tiles[own], row[own], column[own]
        if not casts:
            return tiles[:0], tiles
        any_visible, any_occluded = frame[TILE_VISIBILITY][light][row, column].T
        uncertain = (any_visible & any_occluded) | (not type_of(frame.scene.lights, light).exact)
        if frame.sample == 0:
            return tiles[:0], tiles[any_visible]
        # After each round of the places in the pixel at another one of them, or rays would never start elsewhere.
        rounds = tiles["sample_index"] // len(frame.grid.places)
        phase = draw(Dimension.TEST_TURN, light=light, tile=row * frame.tiles[0] + column, round=rounds)[:, 0]
        probability = CERTAIN_PROBABILITY * influence.bound_over_mean[row, column]
        probability = np.minimum(probability, MAX_CERTAIN_PROBABILITY)
        turn = (tiles["sample_index"] + 1.0) * probability + phase
        tested = ~uncertain & (np.floor(turn) > np.floor(turn - probability))
        tiles["ray_probability"] = np.where(uncertain, 0.0, probability)
        return tiles[uncertain | tested], tiles[any_visible & ~uncertain & ~tested]

    def draw_faint_lights(self, frame: Frame) -> set[int]:
        """All lights that are faint somewhere, one draw for each type; gives those that anything was drawn of."""
        rays, tiles = int(frame.casts_shadows and frame.sample > 0), self.faint_tiles(frame)
        frame.counts["pairs_traced"] += rays * len(tiles) * TILE_SIZE**2
        lights = np.unique(tiles["light"]).astype(int)
        variants = {int(light): shader_variant(frame.scene.lights, light) for light in lights}
        target = frame.framebuffer(DIRECT_PREDICTION, DIRECT_RESIDUAL)
        for variant in {tuple(own.items()): own for own in variants.values()}.values():
            constants = shader_constants(variant, rays, len(frame.grid.places), MIN_FAINT_RAY_PROBABILITY)
            program = self.tile_program(*RECORDS, suffix="faint", **constants)
            bind(
                program,
                **surface_samplers(frame) | material_samplers(frame),
                lights=frame[LIGHT_BUFFER],
                light_steps=light_steps(),
                **ray_sequence(),
                ray_threshold=ray_threshold(frame) if rays else 0.0,
                **(frame[TLAS] if rays else {}),
            )
            of_variant = [light for light, own in variants.items() if own == variant]
            draw_tiles(frame, target, program, tiles[np.isin(tiles["light"], of_variant)])
        return set(variants)

    def faint_tiles(self, frame: Frame) -> np.ndarray:
        """Rows of TILE for each pair of a tile and a faint light that this sample draws."""
        return drawn_pairs(frame[FAINT_LIGHTS], frame[TILES], *frame.tiles, frame.sample)


def casts_shadow(frame: Frame, light: int) -> bool:
    """Whether a light has shadows."""
    return frame.casts_shadows and bool(frame.scene.lights.casts_shadow[light])
