# SPDX-License-Identifier: GPL-3.0-or-later
"""Irradiance by each light: what is predicted of it, and by shadow rays how far that is wrong.

With E the irradiance that nothing hides, exact, and p the predicted part of it, a ray to a point of the light that
would send w E if all of the light were like it corrects by w E (v - p), v being 1 if it arrives: no error where p is
right about a light all seen or all hidden, none on average elsewhere (a control variate). It is the ratio estimator of
Heitz, Hill & McGuire 2018 in another form, whose samples can be added up. Rays are traced with a chance in proportion
to how much they may change the picture, and weigh more the rarer they are. Where nothing is in doubt, rare ones only
tell whether there should be doubt.
"""

import moderngl
import numpy as np

from ....sampling import LIGHT_INCREMENTS, PIXEL_INCREMENTS, TURN_INCREMENTS, fixed_point, members
from ....scene import Change
from ...frame import PREDICTION, TILE_SIZE, Frame, Pass
from ...gl.context import Device
from ...gl.render_targets import Target
from ...gl.shader_compiler import bind
from .ray_correction import RECORDS, LightVariant, count_lights, ray_sequence, ray_threshold, shader_constants

#: The least chance of a ray.
MIN_RAY_PROBABILITY = 0.1

#: The chance of a block in which nothing is in doubt, for a light that could be as bright there as the picture is on
#: average, and the most: where it is brighter, it is the worse if the prediction is wrong.
CERTAIN_PROBABILITY = 0.03125
MAX_CERTAIN_PROBABILITY = 0.5


class TraceShadows(Pass):
    """Irradiance W/m² as predicted, and what rays add to it or take away."""

    # Colours only say how much a ray is worth: a first sample has none, and later ones are always drawn.
    reads = (
        *("blocks", "position", "normal", "depth", "rise", "placement", "lights"),
        *("casters", "reach", "predictions", "foreseen"),
    )
    writes = {"predicted": Target(4, "f4"), "correction": Target(4, "f4")}
    makes = ("used",)  # lights that anything was drawn of
    settings = ("shadow.enabled",)
    depends_on = (Change.LIGHTS, Change.SAMPLE)

    def __init__(self, device: Device):
        super().__init__(device)
        self.all_seen = PREDICTION.create(device.gl, (1, 1))
        PREDICTION.use_neutral(self.all_seen)
        self.framebuffers: dict[int, moderngl.Framebuffer] = {}

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0 and frame.fitted

    def draw(self, frame: Frame) -> None:
        gl, lights = self.device.gl, frame.scene.lights
        frame.targets.into("predicted", "correction").clear()
        gl.enable_only(moderngl.BLEND)
        gl.blend_func = moderngl.ONE, moderngl.ONE
        shifts = members(LIGHT_INCREMENTS, 0, len(lights.shape))
        frame.tables["used"] = used = set()
        predicted, traced_draws = (
            frame.targets.into("predicted"),
            [],
        )  # all of one target first: to change it takes time
        for light, shift in enumerate(shifts):
            traced, shown = self.chosen(frame, light, shift[3])
            if not len(traced) + len(shown):
                continue
            used.add(light)
            kind = LightVariant.of(lights, light)
            shared = {
                **frame.receivers,
                "lights": frame.tables["lights"],
                "light_index": light,
                "pixel_steps": fixed_point(PIXEL_INCREMENTS),
                "depth": frame.targets["depth"],
                "foreseen": frame.targets["foreseen"],
                "prediction": frame.tables["predictions"][light] if self.casts(frame, light) else self.all_seen,
            }
            program = self.tile_program(*RECORDS, **shader_constants(kind, 0, 1, MIN_RAY_PROBABILITY))
            bind(program, **shared)
            self.draw_tiles(frame, predicted, program, shown)
            frame.counts["pixels_refined"] += len(traced) * TILE_SIZE**2
            if len(traced):
                places = {"shift": fixed_point(shift[:3]), **ray_sequence()}
                traced_draws.append((light, kind, shared | places, traced))
        for light, kind, uniforms, traced in traced_draws:
            program = self.tile_program(
                *RECORDS, **shader_constants(kind, 1, len(frame.grid.places), MIN_RAY_PROBABILITY)
            )
            bind(program, **uniforms, enough=ray_threshold(frame), **frame.tables["casters"])
            self.draw_tiles(frame, self.into(frame, light), program, traced)
        count_lights(frame, used)

    def into(self, frame: Frame, light: int) -> moderngl.Framebuffer:
        """Of a light that has rays: the framebuffer that takes what they find, kept as long as its textures are."""
        textures = *(frame.targets[name] for name in self.writes), frame.tables["seen"][light]
        kept = self.framebuffers.get(light)
        if kept is None or kept.color_attachments != textures:
            for gone in self.framebuffers.keys() - frame.tables["seen"].keys():
                del self.framebuffers[gone]
            self.framebuffers[light] = self.device.gl.framebuffer(textures)
        return self.framebuffers[light]

    @staticmethod
    def casts(frame: Frame, light: int) -> bool:
        """Whether a light has shadows."""
        return frame.traces and bool(frame.scene.lights.casts_shadow[light])

    def chosen(self, frame: Frame, light: int, shift: float) -> tuple[np.ndarray, np.ndarray]:
        """Blocks where rays are traced, and those where only the prediction is drawn; elsewhere that is nothing."""
        blocks, reach = frame.tables["blocks"], frame.tables["reach"].get(light)
        casts = self.casts(frame, light)
        if reach is None or (casts and light not in frame.tables["found"]):
            return blocks[:0], blocks[:0]
        column, row = blocks["block"].astype(np.int64).T
        worth = (reach.worth & ~reach.dim)[row, column]
        blocks, row, column = blocks[worth], row[worth], column[worth]
        if not casts:
            return blocks[:0], blocks
        seen, hidden = frame.tables["found"][light][row, column].T
        doubtful = seen & hidden
        if frame.sample == 0:
            return blocks[:0], blocks[seen]
        columns, rows = frame.blocks
        phase = members(TURN_INCREMENTS[:1], 0, columns * rows)[row * columns + column, 0] + shift
        # After each round of the places in the pixel at another one of them, or rays would never start elsewhere.
        phase += blocks["number"] // len(frame.grid.places) * TURN_INCREMENTS[1]
        chance = np.minimum(CERTAIN_PROBABILITY * reach.bright[row, column], MAX_CERTAIN_PROBABILITY)
        turn = (blocks["number"] + 1.0) * chance + phase
        sure = ~doubtful & (np.floor(turn) > np.floor(turn - chance))
        blocks["chance"] = np.where(doubtful, 0.0, chance)
        return blocks[doubtful | sure], blocks[seen & ~doubtful & ~sure]
