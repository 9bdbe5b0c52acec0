# SPDX-License-Identifier: GPL-3.0-or-later
"""Average the samples of a picture: each has other light points and another place in the pixels."""

import moderngl

from ...scene import Change
from ..context import Device
from ..program import bind
from ..targets import Target
from . import Frame, Pass


class Accumulate(Pass):
    """The sum of all samples so far."""

    reads = ("color", "shown")
    writes = {"sum": Target(4, "f4")}
    settings = ("show",)
    depends_on = (Change.SAMPLE,)

    def __init__(self, device: Device):
        super().__init__(device)
        self.pixels = self.full_screen()

    def draw(self, frame: Frame) -> None:
        gl = frame.device.gl
        target = frame.targets.into("sum")
        if frame.sample == 0:
            target.clear()
        target.use()
        gl.enable_only(moderngl.BLEND)
        gl.blend_func = moderngl.ONE, moderngl.ONE
        bind(self.pixels.program, color=frame.targets["color" if frame.settings.show == "color" else "shown"])
        self.pixels.render(moderngl.TRIANGLES, vertices=3)
