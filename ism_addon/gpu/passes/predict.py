# SPDX-License-Identifier: GPL-3.0-or-later
"""What part of each light a pixel will see, from the rays of its neighbours on the same surface.

The rays of a neighbourhood start at evenly spread places on the light, so together they are as good as many of one
pixel's. What is predicted need not be right: Trace says how wrong it is, and is spared work where it is right.
"""

import moderngl
import numpy as np

from ...scene import Change
from ..context import Device
from ..program import bind
from ..targets import Target
from . import BLOCK, SCOUTS_APART, Frame, Pass, blocks_at

#: Of each light and pixel: the part that it is thought to see, and whether that is in doubt.
PREDICTION = Target(2, "f1")

#: Likewise: rays that arrived so far, and rays.
SEEN = Target(2, "f4")

#: What tells surfaces apart, by the names in the shaders.
SURFACES = {"position": "position", "normals": "normal", "depth": "depth"}

#: Samples before which predictions are made: as often as the number of rays is four times what it was.
RENEWED = {0, *(2 * 4**k for k in range(16))}


class Predict(Pass):
    """For each light that casts shadows, the part that a pixel is thought to see."""

    reads = ("scouted", "position", "normal", "depth")
    makes = ("predictions", "seen", "found")
    depends_on = (Change.SAMPLE,)

    def __init__(self, device: Device):
        super().__init__(device)
        self.scouts = self.in_blocks(part="scouts", scouts_apart=SCOUTS_APART)
        self.pixels = self.in_blocks(scouts_apart=SCOUTS_APART)
        self.blocks = self.full_screen(part="blocks")

    def needed(self, frame: Frame) -> bool:
        return frame.traces

    def draw(self, frame: Frame) -> None:
        if frame.sample not in RENEWED:
            return
        tables, first = frame.tables, frame.sample == 0
        if first:
            tables["seen"] = self.unseen(frame)
            tables["found"] = self.by_blocks(frame, tables["scouted"], SCOUTS_APART)
        else:
            for light, found in self.by_blocks(frame, tables["seen"], 1).items():
                tables["found"][light] |= found
        tables["predictions"] = {light: self.predicted(frame, light, not first) for light in tables["found"]}

    def unseen(self, frame: Frame) -> dict[int, moderngl.Texture]:
        """No rays yet; where there were textures of the size, in those."""
        gl, size, kept = self.device.gl, (frame.view.width, frame.view.height), frame.tables.get("seen", {})
        fits = {light: seen for light, seen in kept.items() if seen.size == size}
        seen = {light: fits[light] if light in fits else SEEN.create(gl, size) for light in frame.tables["scouted"]}
        for texture in seen.values():
            gl.framebuffer([texture]).clear()
        return seen

    def by_blocks(self, frame: Frame, rays: dict, apart: int) -> dict[int, np.ndarray]:
        """For each light (H,W,2) bool: whether any ray about a block arrived, and whether any did not."""
        gl, (columns, rows) = self.device.gl, frame.blocks
        texture = gl.texture((columns, rows * len(rays)), 2)
        into = gl.framebuffer([texture])
        into.use()
        gl.enable_only(moderngl.NOTHING)
        for number, found in enumerate(rays.values()):
            into.viewport = 0, number * rows, columns, rows
            bind(self.blocks.program, rays=found, first_row=number * rows, width=BLOCK // apart)
            self.blocks.render(moderngl.TRIANGLES, vertices=3)
        self.device.wait()
        found = np.frombuffer(texture.read(alignment=1), np.uint8).reshape(len(rays), rows, columns, 2) > 0
        return dict(zip(rays, found, strict=True))

    def predicted(self, frame: Frame, light: int, traced: bool) -> moderngl.Texture:
        """All or nothing of a light in blocks whose rays agree; in the others first where scouts were, then between."""
        surfaces = {name: frame.targets[target] for name, target in SURFACES.items()}
        around = self.by_whole_blocks(frame, light, SCOUTS_APART)
        rays = {"scouted": frame.tables["scouted"][light], "seen": frame.tables["seen"][light], "traced": traced}
        doubtful = blocks_at(frame.tables["found"][light].all(2))
        gl = self.device.gl
        bind(self.scouts, **surfaces, **rays)
        self.draw_blocks(frame, gl.framebuffer([around]), self.scouts, doubtful, block=BLOCK // SCOUTS_APART)
        prediction = self.by_whole_blocks(frame, light, 1)
        bind(self.pixels, **surfaces, around=around)
        self.draw_blocks(frame, gl.framebuffer([prediction]), self.pixels, doubtful)
        return prediction

    def by_whole_blocks(self, frame: Frame, light: int, apart: int) -> moderngl.Texture:
        """For each pixel, or those so far apart, whether any ray about its block arrived, and no doubt in that."""
        arrived = frame.tables["found"][light][..., 0]
        width, height = -(-frame.view.width // apart), -(-frame.view.height // apart)
        whole = np.zeros((*arrived.shape, 2), np.uint8)
        whole[..., 0] = np.where(arrived, 255, 0)
        pixels = whole.repeat(BLOCK // apart, 0).repeat(BLOCK // apart, 1)[:height, :width]
        prediction = PREDICTION.create(self.device.gl, (width, height))
        prediction.write(np.ascontiguousarray(pixels), alignment=1)
        return prediction
