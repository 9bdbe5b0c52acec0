# SPDX-License-Identifier: GPL-3.0-or-later
"""Average the samples of a picture: each has other places on the lights and another place in the pixels.

A sample counts for all pixels whose Blackman-Harris filter reaches it, by that filter's weight there. Beyond its own
block it counts more or less, as that block takes part less or more often than the pixel's own: or pixels between two
blocks would look like the one drawn more often. For pixels of a block that is settled it counts nothing.
"""

import math

import moderngl

from ...scene import Change
from ..program import bind
from ..targets import Target
from . import Frame, Pass


def margin(reach: float) -> int:
    """Pixels away that a sample can count for, which is up to half a pixel off its own one's centre.

    Where that is none, samples are spread as the filter is, and all count alike.
    """
    return max(math.ceil(reach - 0.5), 0)


class Accumulate(Pass):
    """The sums of all samples so far: what was predicted, what corrects it, what may be added, and the weights."""

    reads = ("blocks", "chances", "color", "color_correction", "headroom", "shown")
    writes = {
        **{name: Target(4, "f4") for name in ("sum", "sum_correction", "weights")},
        "sum_headroom": Target(1, "f4"),
    }
    settings = ("show",)
    depends_on = (Change.SAMPLE,)

    def draw(self, frame: Frame) -> None:
        gl = frame.device.gl
        first, colored, reach = frame.sample == 0, frame.settings.show == "color", frame.view.filter_width
        gl.enable_only(moderngl.NOTHING if first else moderngl.BLEND)
        gl.blend_func = moderngl.ONE, moderngl.ONE
        corrected = colored and not first  # the first sample is predicted, no more; all blocks take part in it
        program = self.in_blocks(margin=margin(reach), corrected=int(corrected), whole=int(first))
        bind(
            program,
            color=frame.targets["color" if colored else "shown"],
            correction=frame.targets["color_correction"],
            headroom=frame.targets["headroom"],
            chances=frame.tables["chances"],
            reach=reach,
        )
        self.draw_blocks(frame, frame.targets.into(*self.writes), program, margin=0 if first else margin(reach))
