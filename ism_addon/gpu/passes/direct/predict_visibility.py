# SPDX-License-Identifier: GPL-3.0-or-later
"""What part of each light a pixel will see, from the rays of its neighbours on the same surface.

The rays of a neighbourhood start at evenly spread places on the light, so together they are as good as many of one
pixel's. What is predicted need not be right: TraceShadows says how wrong it is, and is spared work where it is right.
"""

from functools import cached_property

import moderngl
import numpy as np

from ....scene import Change
from ...frame import (
    PREDICTION,
    PROBE_SPACING,
    PROBES,
    PROBES_PER_TILE_SIDE,
    RENEWED,
    TILE_SIZE,
    UNKNOWN_VISIBILITY,
    Frame,
    Pass,
    from_tile_layout,
    tiles_where,
)
from ...gl import driver_variants
from ...gl.render_targets import Target, pixels
from ...gl.shader_compiler import bind

#: Of each light and pixel: rays that arrived so far, and rays.
RAY_COUNTS = Target(2, "f4")

#: Of each light and block: whether any ray about it arrived, and whether any did not.
TILE_VISIBILITY = Target(2, "f1", divisor=TILE_SIZE, strips=True)


class PredictVisibility(Pass):
    """For each light that casts shadows, the part that a pixel is thought to see."""

    reads = ("scouted", "spotted", "reach", "position", "normal", "depth")
    writes = {
        "around": Target(2, "f2", divisor=PROBE_SPACING),  # a light's prediction where scouts were
        "foreseen": Target(4, "f4"),  # position, with normals, of what was predicted
    }
    makes = ("predictions", "seen", "found", "looks")
    depends_on = (Change.SAMPLE,)

    @cached_property
    def scouts(self) -> moderngl.Program:
        return self.tile_program(part="probes", probe_spacing=PROBE_SPACING)

    @cached_property
    def pixels(self) -> moderngl.Program:
        return self.tile_program(probe_spacing=PROBE_SPACING)

    @cached_property
    def blocks(self) -> moderngl.VertexArray:
        return self.full_screen_program(part="tiles", tile_size=TILE_SIZE)

    def needed(self, frame: Frame) -> bool:
        return frame.traces

    def draw(self, frame: Frame) -> None:
        if frame.sample not in RENEWED:
            return
        tables, first = frame.tables, frame.sample == 0
        if first:
            found = self.by_blocks(frame, tables["scouted"], PROBE_SPACING)
            for light in np.flatnonzero(frame.scene.lights.spread < np.pi):
                if light in found:  # a cone may light what lies between rays, none of which it was worth to send
                    found[light][tables["reach"][light].scouted & ~found[light].any(2)] = True
            if not frame.settings.shortcuts:
                found = {light: np.ones_like(blocks) for light, blocks in found.items()}
            tables["found"] = {light: blocks for light, blocks in found.items() if blocks[..., 0].any()}
            tables["looks"] = dict(
                tables["scouted"]
            )  # some are added; what ProbeVisibility made may serve the next picture too
            tables["seen"] = self.textures_per_light(frame, "seen", RAY_COUNTS)
            for texture in tables["seen"].values():
                self.device.gl.framebuffer([texture]).clear()
        else:
            for light, found in self.by_blocks(frame, tables["seen"], 1).items():
                tables["found"][light] |= found
            self.add(frame, tables["spotted"])
        self.device.gl.copy_framebuffer(frame.targets.into("foreseen"), frame.targets.into("position"))
        tables["predictions"] = self.textures_per_light(frame, "predictions", PREDICTION)
        for light, prediction in tables["predictions"].items():
            self.predict(frame, light, prediction, not first)

    def textures_per_light(self, frame: Frame, table: str, target: Target) -> dict[int, moderngl.Texture]:
        """A texture of the picture's size; that which the table has, if it fits."""
        size, kept = (frame.view.width, frame.view.height), frame.tables.get(table, {})
        fits = {light: texture for light, texture in kept.items() if texture.size == driver_variants.sides(size)}
        lights = frame.tables["found"]
        return {light: fits[light] if light in fits else target.create(self.device.gl, size) for light in lights}

    def add(self, frame: Frame, spotted: dict[int, np.ndarray]) -> None:
        """Lights that had seemed hidden, and the blocks (rows,columns) where they are not."""
        for light, seen in spotted.items():
            reach = frame.tables["reach"][light]
            reach.seen[seen] = np.maximum(reach.seen[seen], UNKNOWN_VISIBILITY)
            if light in frame.tables["found"] or not (seen & ~reach.dim).any():
                continue
            frame.tables["found"][light] = np.stack([seen, np.ones_like(seen)], 2)
            for table, target in (("looks", PROBES), ("seen", RAY_COUNTS)):
                size = -(-frame.view.width // target.divisor), -(-frame.view.height // target.divisor)
                frame.tables[table][light] = target.create(self.device.gl, size)
                self.device.gl.framebuffer([frame.tables[table][light]]).clear()

    def by_blocks(self, frame: Frame, rays: dict, apart: int) -> dict[int, np.ndarray]:
        """For each light (H,W,2) bool: whether any ray about a block arrived, and whether any did not."""
        gl = self.device.gl
        size = TILE_VISIBILITY.size(frame.view.width, frame.view.height)
        found = {light: TILE_VISIBILITY.create(gl, size) for light in rays}
        for light, texture in found.items():
            target = gl.framebuffer([texture])
            self.draw_per_tile(frame, target, self.blocks, rays=rays[light], apart=apart)
        self.device.wait()
        return {light: from_tile_layout(pixels(texture), frame.blocks) > 0.0 for light, texture in found.items()}

    def predict(self, frame: Frame, light: int, prediction: moderngl.Texture, traced: bool) -> None:
        """All or nothing of a light in blocks whose rays agree; in the others first where scouts were, then between."""
        tables, targets = frame.tables, frame.targets
        found = tables["found"][light]
        surfaces = {"position": targets["position"], "normals": targets["normal"], "depth": targets["depth"]}
        rays = {"scouted": tables["looks"][light], "seen": tables["seen"][light], "traced": traced}
        gl, around, doubtful = self.device.gl, targets.into("around"), tiles_where(found.all(2))
        write_tiles(targets["around"], targets.sizes["around"], found[..., 0], PROBES_PER_TILE_SIDE)
        bind(self.scouts, **surfaces, **rays)
        self.draw_tiles(frame, around, self.scouts, doubtful, block=PROBES_PER_TILE_SIDE)
        write_tiles(prediction, (frame.view.width, frame.view.height), found[..., 0], TILE_SIZE)
        bind(self.pixels, **surfaces, around=targets["around"])
        self.draw_tiles(frame, gl.framebuffer([prediction]), self.pixels, doubtful)


def write_tiles(prediction: moderngl.Texture, size: tuple[int, int], arrived: np.ndarray, block: int) -> None:
    """Predict for blocks (rows,columns) bool that all of a light arrives or nothing, and no doubt about it."""
    pixels = np.zeros((*arrived.shape, 2), np.float16)
    pixels[..., 0] = arrived
    whole = np.ascontiguousarray(pixels.repeat(block, 1).repeat(block, 0)[: size[1], : size[0]])
    prediction.write(whole, (0, 0, *size), alignment=1)
