# SPDX-License-Identifier: GPL-3.0-or-later
"""Average the samples of a picture: each has other light points and another place in the pixels."""

import moderngl

from ...scene import Change
from ..context import Device
from ..program import bind
from ..targets import Target
from . import Frame, Pass


class Accumulate(Pass):
    """The sums of all samples so far: what was predicted, what corrects it, and the squares of both together."""

    reads = ("blocks", "color", "color_correction", "shown")
    writes = {"sum": Target(4, "f4"), "sum_correction": Target(4, "f4"), "squares": Target(1, "f4")}
    settings = ("show",)
    depends_on = (Change.SAMPLE,)

    def __init__(self, device: Device):
        super().__init__(device)
        self.pixels = self.in_blocks()

    def draw(self, frame: Frame) -> None:
        gl = frame.device.gl
        target = frame.targets.into(*self.writes)
        if frame.sample == 0:
            target.clear()
        gl.enable_only(moderngl.BLEND)
        gl.blend_func = moderngl.ONE, moderngl.ONE
        colored = frame.settings.show == "color"
        bind(
            self.pixels,
            color=frame.targets["color" if colored else "shown"],
            correction=frame.targets["color_correction"],
            corrected=colored,
        )
        self.draw_blocks(frame, target, self.pixels)
