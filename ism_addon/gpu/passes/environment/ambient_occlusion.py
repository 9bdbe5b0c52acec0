# SPDX-License-Identifier: GPL-3.0-or-later
"""Darken what is close to other surfaces, in screen space at half resolution.

Beck-Norén & Valter 2013, sections 2.2 and 3.3, after Mittring 2007: points within a radius and a cone about the
normal are projected to the screen; one that lies behind what is seen there is occluded, the less the farther away
the occluder is. A tiled 64×64 random texture turns the points from pixel to pixel. The points are spread by the
cosine, so that without attenuation the open part is the part of the world's light that arrives.
"""

from functools import cached_property

import moderngl
import numpy as np

from ....sampling import Dimension, rd_sequence, sequence
from ....scene import Change
from ...frame import Frame, Pass
from ...gl import driver_variants
from ...gl.render_targets import Target
from ...gl.shader_compiler import bind

#: Side of the random texture, as in the report.
NOISE_SIZE = 64

#: Points a pixel and sample. Chosen with the report's budget in mind; more samples add more.
SAMPLES = 16


class AmbientOcclusion(Pass):
    """The part of the world's light that reaches each pixel: 1 is open."""

    reads = ("depth", "position", "normal")
    writes = {"occlusion": Target(1, "f2", neutral=(1.0,), divisor=2)}
    settings = ("ssao",)
    depends_on = (Change.VIEW, Change.SAMPLE)

    @cached_property
    def pixels(self) -> moderngl.VertexArray:
        pixels = self.full_screen_program(points=SAMPLES, tile=NOISE_SIZE)
        pixels.program["cone_points"].write(rd_sequence(0, SAMPLES, 3).astype("f4"))
        return pixels

    @cached_property
    def random(self) -> moderngl.Texture:
        random = np.random.default_rng(2013).uniform(-1.0, 1.0, (NOISE_SIZE, NOISE_SIZE, 2)).astype("f4")
        texture = self.device.gl.texture((NOISE_SIZE, NOISE_SIZE), 2, random, dtype="f4")
        driver_variants.never_filtered(texture)
        return texture

    def needed(self, frame: Frame) -> bool:
        return frame.occludes

    def draw(self, frame: Frame) -> None:
        ssao = frame.settings.ssao
        frame.device.gl.enable_only(moderngl.NOTHING)
        bind(
            self.pixels.program,
            depth=frame.targets["depth"],
            position=frame.targets["position"],
            normals=frame.targets["normal"],
            random=self.random,
            turn=sequence(Dimension.OCCLUSION_TURN, frame.sample, 1)[0, 0],
            radius=ssao.radius,
            cone_sine=np.sin(ssao.cone_angle / 2.0),
            intensity=ssao.intensity,
            attenuation=ssao.attenuation,
        )
        self.draw_pixels(frame, frame.targets.into("occlusion"), self.pixels)
