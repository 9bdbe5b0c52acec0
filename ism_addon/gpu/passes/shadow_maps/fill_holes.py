# SPDX-License-Identifier: GPL-3.0-or-later
"""Fill the holes between the discs by pull-push interpolation.

Marroquim, Kraus & Cavalcanti 2007. Pull: a coarser texel averages those of its four finer ones whose depth lies
within a threshold of the nearest. Push: a finer texel that is empty, or lies behind the coarser surface by more than
the threshold, takes the coarser depth. We also store each texel's coverage, the fraction of it that its surface fills,
and push only where more than half is covered: holes are filled, but outlines do not grow. Three levels bridge eight
texels. As maps' sides are multiples of eight, no coarser texel spans two maps.
"""

from functools import cached_property

import moderngl

from ....resource_types import Target
from ....resources import ATLAS_BATCH, NO_OCCLUDER, SHADOW_MAP_SPLATS, SHADOW_MAPS
from ...drawing import draw_pixels
from ...frame import Frame, Pass, outputs
from ...gl.shader_compiler import bind, compile_program
from .atlas import MAP_SIZE_MULTIPLE

LEVELS = MAP_SIZE_MULTIPLE.bit_length() - 1


def _level(name: str) -> Target:
    return Target(name, "Depth in metres, coverage", format=SHADOW_MAPS.format, divisor=0, neutral=None)


#: Targets of the coarser levels, 1 … LEVELS.
PULLED = [_level(f"pulled_{level}") for level in range(1, LEVELS + 1)]
PUSHED = [_level(f"pushed_{level}") for level in range(1, LEVELS)]


class FillHoles(Pass):
    """The atlas of one batch without the holes."""

    inputs = SHADOW_MAP_SPLATS, ATLAS_BATCH, "shadow.fill_threshold", "shadow.fill_holes"
    outputs = outputs(SHADOW_MAPS, *PULLED, *PUSHED)

    @cached_property
    def steps(self) -> dict[str, moderngl.VertexArray]:
        programs = {
            name: compile_program(
                self.device, "glsl/full_screen.vert", f"passes/shadow_maps/{name}.frag", empty=NO_OCCLUDER
            )
            for name in ("pull", "push")
        }
        return {name: self.device.gl.vertex_array(program, []) for name, program in programs.items()}

    def needed(self, frame: Frame) -> bool:
        return frame.casts_shadows and frame[ATLAS_BATCH].count > 0 and frame.settings.shadow.fill_holes

    def execute(self, frame: Frame) -> None:
        frame.device.overwrite()
        width, height = frame[ATLAS_BATCH].size
        for level, pulled in enumerate(PULLED, 1):
            frame.allocate(pulled, (width >> level, height >> level))
        for level, pushed in enumerate([SHADOW_MAPS, *PUSHED]):
            frame.allocate(pushed, (width >> level, height >> level))
        fine = [SHADOW_MAP_SPLATS, *PULLED]
        for level in range(LEVELS):
            self.step("pull", frame, fine[level], SHADOW_MAP_SPLATS, PULLED[level], level)
        coarse = PULLED[-1]
        for level in reversed(range(LEVELS)):
            into = PUSHED[level - 1] if level else SHADOW_MAPS
            self.step("push", frame, fine[level], coarse, into, level)
            coarse = into

    def step(self, name: str, frame: Frame, fine: Target, coarse: Target, into: Target, level: int) -> None:
        """Pull from `level` to the next coarser one, or push from there to `level`."""
        vertices = self.steps[name]
        uniforms = {"fine": frame[fine], "finest": level == 0, "threshold": frame.settings.shadow.fill_threshold}
        if name == "push":
            uniforms |= {"coarse": frame[coarse], "coarse_side": frame[ATLAS_BATCH].side >> (level + 1)}
        bind(vertices.program, **uniforms)
        draw_pixels(frame, frame.framebuffer(into), vertices)
