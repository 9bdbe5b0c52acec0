# SPDX-License-Identifier: GPL-3.0-or-later
"""What part of each light a pixel will see, from the rays of its neighbours on the same surface.

The rays of a neighbourhood start at evenly spread places on the light, so together they are as good as many of one
pixel's. What is predicted need not be right: Trace says how wrong it is, and is spared work where it is right.
"""

import moderngl
import numpy as np

from ...scene import Change
from ..context import Device
from ..program import bind, compile_program
from ..targets import Target
from . import BLOCK, Frame, Pass

#: Of each light and pixel: the part that it is thought to see, and whether that is in doubt.
PREDICTION = Target(2, "f1")

#: Likewise: rays that arrived so far, and rays.
SEEN = Target(2, "f4")


#: Samples before which predictions are made: as often as the number of rays is four times what it was.
RENEWED = {0, *(2 * 4**k for k in range(16))}


class Predict(Pass):
    """For each light that casts shadows, the part that a pixel is thought to see."""

    reads = ("scouted", "position", "normal", "depth")
    makes = ("predictions", "seen", "doubts")
    depends_on = (Change.SAMPLE,)

    def __init__(self, device: Device):
        super().__init__(device)
        self.pixels = self.full_screen()
        self.doubts = compile_program(device, "full_screen.vert", "predict_doubts.frag", block=BLOCK)

    def needed(self, frame: Frame) -> bool:
        return frame.traces

    def draw(self, frame: Frame) -> None:
        if frame.sample not in RENEWED:
            return
        gl, size, scouted = self.device.gl, (frame.view.width, frame.view.height), frame.tables["scouted"]
        if frame.sample == 0:
            frame.tables["predictions"] = {light: PREDICTION.create(gl, size) for light in scouted}
            frame.tables["seen"] = {light: SEEN.create(gl, size) for light in scouted}
            for seen in frame.tables["seen"].values():
                gl.framebuffer([seen]).clear()
        gl.enable_only(moderngl.NOTHING)
        for light, prediction in frame.tables["predictions"].items():
            gl.framebuffer([prediction]).use()
            bind(
                self.pixels.program,
                position=frame.targets["position"],
                normals=frame.targets["normal"],
                depth=frame.targets["depth"],
                scouted=scouted[light],
                seen=frame.tables["seen"][light],
                traced=frame.sample > 0,
            )
            self.pixels.render(moderngl.TRIANGLES, vertices=3)
        frame.tables["doubts"] = self.by_blocks(frame)

    def by_blocks(self, frame: Frame) -> dict[int, np.ndarray]:
        """For each light (H,W,2) bool: whether a block is thought to see any of it, and whether that is in doubt."""
        gl, (columns, rows), predictions = self.device.gl, frame.blocks, frame.tables["predictions"]
        texture = gl.texture((columns, rows * len(predictions)), 2)
        target = gl.framebuffer([texture])
        target.use()
        for number, prediction in enumerate(predictions.values()):
            target.viewport = 0, number * rows, columns, rows
            bind(self.doubts, prediction=prediction, first_row=number * rows)
            gl.vertex_array(self.doubts, []).render(moderngl.TRIANGLES, vertices=3)
        self.device.wait()
        found = np.frombuffer(texture.read(alignment=1), np.uint8).reshape(len(predictions), rows, columns, 2) > 0
        return dict(zip(predictions, found, strict=True))
