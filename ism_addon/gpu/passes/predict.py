# SPDX-License-Identifier: GPL-3.0-or-later
"""What part of each light a pixel will see, from the rays of its neighbours on the same surface.

The rays of a neighbourhood start at evenly spread places on the light, so together they are as good as many of one
pixel's. What is predicted need not be right: Trace says how wrong it is, and is spared work where it is right.
"""

import moderngl

from ...scene import Change
from ..context import Device
from ..program import bind
from ..targets import Target
from . import Frame, Pass

#: Of each light and pixel: the part that it is thought to see, and whether that is in doubt.
PREDICTION = Target(2, "f1")

#: Likewise: rays that arrived so far, and rays.
SEEN = Target(2, "f4")


class Predict(Pass):
    """For each light that casts shadows, the part that a pixel is thought to see."""

    reads = ("scouted", "position", "normal", "depth")
    makes = ("predictions", "seen")
    depends_on = (Change.SAMPLE,)

    def __init__(self, device: Device):
        super().__init__(device)
        self.pixels = self.full_screen()

    def needed(self, frame: Frame) -> bool:
        return frame.traces

    def draw(self, frame: Frame) -> None:
        if frame.sample & (frame.sample - 1):  # as often as the number of rays has doubled
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
