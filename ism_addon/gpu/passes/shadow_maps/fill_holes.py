# SPDX-License-Identifier: GPL-3.0-or-later
"""Fill the holes between the discs by pull-push interpolation.

Marroquim, Kraus & Cavalcanti 2007. Pull: a coarser texel averages those of its four finer ones whose depth lies
within a threshold of the nearest. Push: a finer texel that is empty, or lies behind the coarser surface by more than
the threshold, takes the coarser depth. We add a coverage to each texel, the part of it that its surface fills, and
push only where more than half is covered: a hole is filled, an outline does not grow. Three levels bridge eight
texels; each halving stays within a map, as maps' sides are multiples of eight.
"""

from functools import cached_property

import moderngl

from ...atlas import MAP_SIZE_MULTIPLE, NO_OCCLUDER
from ...frame import Frame, Pass
from ...gl.render_targets import Target
from ...gl.shader_compiler import bind, compile_program

LEVELS = MAP_SIZE_MULTIPLE.bit_length() - 1
PULL_PUSH_LEVEL = Target(2, "f4", neutral=(NO_OCCLUDER, 0.0), divisor=0)  # depth in m, coverage


class FillHoles(Pass):
    """The atlas of one batch without the holes."""

    reads = ("splats",)
    writes = {"shadow_maps": PULL_PUSH_LEVEL}
    settings = ("shadow.fill_threshold",)

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
        return frame.splats and frame.batch.count > 0 and frame.settings.shadow.fill_holes

    def draw(self, frame: Frame) -> None:
        frame.device.gl.enable_only(moderngl.NOTHING)
        width, height = frame.batch.size
        for level in range(1, LEVELS + 1):
            frame.targets.allocate(f"pull {level}", PULL_PUSH_LEVEL, (width >> level, height >> level))
            frame.targets.allocate(f"push {level}", PULL_PUSH_LEVEL, (width >> level, height >> level))
        frame.targets.allocate("shadow_maps", PULL_PUSH_LEVEL, (width, height))
        for level in range(1, LEVELS + 1):
            self.step("pull", frame, f"pull {level}", level - 1)
        for level in reversed(range(LEVELS)):
            self.step("push", frame, f"push {level}" if level else "shadow_maps", level)

    def step(self, name: str, frame: Frame, into: str, level: int) -> None:
        """Pull from `level` to the next coarser, or push to `level` from there."""
        targets = frame.targets
        above = f"push {level + 1}" if level + 1 < LEVELS else f"pull {LEVELS}"
        vertices = self.steps[name]
        bind(
            vertices.program,
            fine=targets[f"pull {level}" if level else "splats"],
            finest=level == 0,
            coarse=targets[above if name == "push" else "splats"],
            coarse_side=frame.batch.side >> (level + 1),
            threshold=frame.settings.shadow.fill_threshold,
        )
        self.draw_pixels(frame, targets.into(into), vertices)
