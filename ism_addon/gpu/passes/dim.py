# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights that are a small part of a block's light, all at once: the same part of one is predicted for all its pixels.

As many as there may be, they need no predictions of their own: see Reach for the part, and Trace for the rays.
"""

import moderngl
import numpy as np

from ...sampling import LIGHT_STEPS, PIXEL_STEPS, RAY_STEPS
from ...scene import Change
from ..program import bind
from ..refine import RECORDS, Kind, constants_of, count_used, enough
from . import BLOCK, Frame, Pass

#: The least chance of a ray.
LEAST_CHANCE = 0.05


class Dim(Pass):
    """What they add to what Trace has drawn."""

    # No more than Trace depends on: what is added to is always new.
    reads = (
        *("predicted", "correction", "blocks", "position", "normal"),
        *("rise", "placement", "lights", "casters", "reach"),
    )
    settings = ("shadow.enabled",)
    depends_on = (Change.LIGHTS, Change.SAMPLE)

    def needed(self, frame: Frame) -> bool:
        lit = len(frame.scene.lights.shape) > 0 and frame.fitted
        return lit and any(to.dim.any() for to in frame.tables["reach"].values())

    def draw(self, frame: Frame) -> None:
        gl, lights, rays = self.device.gl, frame.scene.lights, int(frame.traces and frame.sample > 0)
        gl.enable_only(moderngl.BLEND)
        gl.blend_func = moderngl.ONE, moderngl.ONE
        target = frame.targets.into("predicted", "correction")
        blocks = self.chosen(frame)
        frame.counts["pixels_refined"] += rays * len(blocks) * BLOCK**2
        kind_of = {light: Kind.of(lights, light) for light in np.unique(blocks["light"]).astype(int)}
        for kind in dict.fromkeys(kind_of.values()):
            program = self.in_blocks(*RECORDS, **constants_of(kind, rays, len(frame.grid.places), LEAST_CHANCE))
            bind(
                program,
                **frame.receivers,
                lights=frame.tables["lights"],
                pixel_steps=PIXEL_STEPS,
                light_steps=LIGHT_STEPS,
                ray_steps=RAY_STEPS,
                enough=enough(frame) if rays else 0.0,
                **frame.tables.get("casters", {}),
            )
            alike = [light for light, own in kind_of.items() if own == kind]
            self.draw_blocks(frame, target, program, blocks[np.isin(blocks["light"], alike)])
        frame.tables["used"].update(kind_of)
        count_used(frame, frame.tables["used"])

    @staticmethod
    def chosen(frame: Frame) -> np.ndarray:
        """Rows of BLOCKS for each light that is dim there; the part that is thought to be seen of it is `sure`."""
        blocks = frame.tables["blocks"]
        column, row = blocks["block"].astype(np.int64).T
        found = [blocks[:0]]
        for light, reach in frame.tables["reach"].items():
            seen = reach.dim * reach.seen
            if seen.any():
                seen = seen[row, column]
                found.append(blocks[seen > 0.0])
                found[-1]["light"], found[-1]["sure"] = light, seen[seen > 0.0]
        return np.concatenate(found)
