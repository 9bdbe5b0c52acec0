# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights that are a small part of a tile's light, all in one draw: one visibility for all pixels of a tile.

They have no prediction of their own, however many they are: CullLights estimates the visibility, and rays correct it as
in TraceShadows. The fainter a light is, the lower is its probability in a sample, and the higher its weight.
"""

import moderngl
import numpy as np

from ....sampling import LIGHT_INCREMENTS, PIXEL_INCREMENTS, TURN_INCREMENTS, fixed_point, members
from ....scene import Change
from ...frame import TILE_SIZE, Frame, Pass
from ...gl.context import Device
from ...gl.shader_compiler import bind
from .ray_correction import RECORDS, LightVariant, count_lights, ray_sequence, ray_threshold, shader_constants

#: The least chance of a ray.
MIN_FAINT_RAY_PROBABILITY = 0.05

#: The least chance of a light's turn.
MIN_LIGHT_PROBABILITY = 0.25

#: A light that is dim in a block: its part that is thought to be seen, and how often it has a turn, and when.
FAINT_LIGHT = np.dtype([("block", "i8"), ("light", "i8"), ("part", "f4"), ("chance", "f4"), ("phase", "f4")])


class TraceFaintLights(Pass):
    """What they add to what TraceShadows has drawn."""

    # No more than TraceShadows depends on: what is added to is always new.
    reads = (
        *("predicted", "correction", "blocks", "position", "normal"),
        *("rise", "placement", "lights", "casters", "reach"),
    )
    settings = ("shadow.enabled",)
    depends_on = (Change.LIGHTS, Change.SAMPLE)

    def __init__(self, device: Device):
        super().__init__(device)
        self.reach: dict | None = None
        self.pairs = np.zeros(0, FAINT_LIGHT)

    def needed(self, frame: Frame) -> bool:
        lit = len(frame.scene.lights.shape) > 0 and frame.fitted
        return lit and any(to.dim.any() for to in frame.tables["reach"].values())

    def draw(self, frame: Frame) -> None:
        gl, lights, rays = self.device.gl, frame.scene.lights, int(frame.traces and frame.sample > 0)
        gl.enable_only(moderngl.BLEND)
        gl.blend_func = moderngl.ONE, moderngl.ONE
        target = frame.targets.into("predicted", "correction")
        blocks = self.chosen(frame)
        frame.counts["pixels_refined"] += rays * len(blocks) * TILE_SIZE**2
        kind_of = {light: LightVariant.of(lights, light) for light in np.unique(blocks["light"]).astype(int)}
        for kind in dict.fromkeys(kind_of.values()):
            program = self.tile_program(
                *RECORDS, **shader_constants(kind, rays, len(frame.grid.places), MIN_FAINT_RAY_PROBABILITY)
            )
            bind(
                program,
                **frame.receivers,
                lights=frame.tables["lights"],
                pixel_steps=fixed_point(PIXEL_INCREMENTS),
                light_steps=fixed_point(LIGHT_INCREMENTS[:3]),
                **ray_sequence(),
                enough=ray_threshold(frame) if rays else 0.0,
                **frame.tables.get("casters", {}),
            )
            alike = [light for light, own in kind_of.items() if own == kind]
            self.draw_tiles(frame, target, program, blocks[np.isin(blocks["light"], alike)])
        frame.tables["used"].update(kind_of)
        count_lights(frame, frame.tables["used"])

    def chosen(self, frame: Frame) -> np.ndarray:
        """Rows of TILE for each light that is dim there, if it is its turn; numbers count those that it had."""
        blocks, (columns, rows) = frame.tables["blocks"], frame.blocks
        if frame.tables["reach"] is not self.reach:
            self.reach = frame.tables["reach"]
            self.pairs = faint_light_pairs(self.reach)
        taking_part = np.full(columns * rows, -1)
        taking_part[blocks["block"].astype(np.int64) @ (1, columns)] = np.arange(len(blocks))
        pairs = self.pairs[taking_part[self.pairs["block"]] >= 0]
        found = blocks[taking_part[pairs["block"]]]
        chance = pairs["chance"] if frame.sample > 0 else np.ones(len(pairs), np.float32)
        turn = found["number"] * chance + pairs["phase"]
        found["number"], found["chance"] = np.floor(turn), chance
        found["light"], found["part"] = pairs["light"], pairs["part"]
        return found[np.floor(turn + chance) > found["number"]]


def faint_light_pairs(reach: dict) -> np.ndarray:
    """Rows of FAINT_LIGHT for all blocks and the lights that are dim there."""
    found = [np.zeros(0, FAINT_LIGHT)]
    for light, to in reach.items():
        part = (to.dim * to.seen).ravel()
        block = np.flatnonzero(part)
        pairs = np.zeros(len(block), FAINT_LIGHT)
        pairs["block"], pairs["light"], pairs["part"] = block, light, part[block]
        pairs["chance"] = np.maximum(to.against_dim.ravel()[block], MIN_LIGHT_PROBABILITY)
        pairs["phase"] = np.mod(members(TURN_INCREMENTS[:1], 0, part.size)[block, 0] + light * LIGHT_INCREMENTS[3], 1.0)
        found.append(pairs)
    return np.concatenate(found)
