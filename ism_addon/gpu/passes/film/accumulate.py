# SPDX-License-Identifier: GPL-3.0-or-later
"""Average the samples of a picture: each has other places on the lights and another place in the pixels.

A sample counts for all pixels whose Blackman-Harris filter reaches it, by that filter's weight there. Beyond its own
block it counts more or less, as that block takes part less or more often than the pixel's own: or pixels between two
blocks would look like the one drawn more often. For pixels of a block that is settled it counts nothing.

A wide filter would take its width squared for each pixel, and again for each that it reaches: it is drawn across, then
along. Samples count as if they lay at the pixels' centres then, as each block's are elsewhere. That would blur the
filter by a pixel, so it is narrower by as much.
"""

import math
from dataclasses import replace

import moderngl

from ....scene import Change
from ...frame import TILE_SIZE, Frame, Pass
from ...gl.draw_limit import TEXELS_PER_RAY
from ...gl.render_targets import Target
from ...gl.shader_compiler import bind

#: Pixels of margin from which on a filter is wide.
WIDE_MARGIN = 5

#: Samples that are fetched and weighed in the time that it takes to add to a sum.
SAMPLES_PER_BLEND = 4

#: A pixel's variance, over that of a Blackman-Harris filter that reaches 1 px: 1 / 12 / 0.076736.
RELATIVE_VARIANCE = 1.08598

SUMS = {**{name: Target(4, "f4") for name in ("sum", "sum_correction", "weights")}, "sum_headroom": Target(1, "f4")}
#: Of wide filters: what of a sample counts at all, and the same after it is filtered in rows.
TAKEN = {f"taken_{name}": replace(target, divisor=0) for name, target in SUMS.items()}
ROWS = {f"rows_{name}": replace(target, divisor=0) for name, target in SUMS.items()}


def filter_margin(reach: float) -> int:
    """Pixels away that a sample can count for, which is up to half a pixel off its own one's centre.

    Where that is none, samples are spread as the filter is, and all count alike.
    """
    return max(math.ceil(reach - 0.5), 0)


def rays_for(samples: int) -> float:
    """In whose time so many samples are added to a pixel's sums."""
    return len(SUMS) * (samples + SAMPLES_PER_BLEND) / TEXELS_PER_RAY


class Accumulate(Pass):
    """The sums of all samples so far: what was predicted, what corrects it, what may be added, and the weights."""

    reads = ("blocks", "chances", "color", "color_correction", "headroom", "shown")
    writes = {**SUMS, **TAKEN, **ROWS}
    settings = ("debug_view",)
    depends_on = (Change.SAMPLE,)

    def draw(self, frame: Frame) -> None:
        gl = frame.device.gl
        first, colored, reach = frame.sample == 0, frame.settings.debug_view == "color", frame.view.filter_width
        adding = moderngl.NOTHING if first else moderngl.BLEND
        gl.blend_func = moderngl.ONE, moderngl.ONE
        corrected = int(colored and not first)  # the first sample is predicted, no more; all blocks take part in it
        samples = {
            "color": frame.targets["color" if colored else "shown"],
            "correction": frame.targets["color_correction"],
            "headroom": frame.targets["headroom"],
            "chances": frame.tables["chances"],
        }
        if filter_margin(reach) < WIDE_MARGIN:
            gl.enable_only(adding)
            program = self.tile_program(margin=filter_margin(reach), corrected=corrected, whole=int(first))
            bind(program, **samples, reach=reach)
            rays = rays_for((2 * filter_margin(reach) + 1) ** 2)
            around = 0 if first else filter_margin(reach)
            self.draw_tiles(frame, frame.targets.into(*SUMS), program, margin=around, rays=rays)
            return
        gl.enable_only(moderngl.NOTHING)
        for name, target in (*TAKEN.items(), *ROWS.items()):
            frame.targets.allocate(name, target, frame.targets.sizes["sum"])
        taken = frame.targets.into(*TAKEN)
        taken.clear()
        program = self.tile_program(part="taken", corrected=corrected)
        bind(program, **samples)
        self.draw_tiles(frame, taken, program, rays=rays_for(1))
        self.draw_lines(frame, TAKEN, ROWS)
        gl.enable_only(adding)
        self.draw_lines(frame, ROWS, SUMS)

    def draw_lines(self, frame: Frame, source: dict[str, Target], into: dict[str, Target]) -> None:
        """Filter along rows or, into the sums, along columns."""
        lines, reach = (
            self.full_screen_program(part="lines", tile_size=TILE_SIZE, columns=int(into is SUMS)),
            frame.view.filter_width,
        )
        narrower = math.sqrt(reach * reach - RELATIVE_VARIANCE)
        samplers = "taken", "taken_correction", "taken_weights", "taken_headroom"
        textures = {sampler: frame.targets[name] for sampler, name in zip(samplers, source, strict=True)}
        bind(lines.program, **textures, chances=frame.tables["chances"], reach=narrower, margin=filter_margin(reach))
        self.draw_pixels(frame, frame.targets.into(*into), lines, rays_for(2 * filter_margin(reach) + 1))
