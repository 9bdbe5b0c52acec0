# SPDX-License-Identifier: GPL-3.0-or-later
"""Put together what a pixel sends to the camera, in linear light.

Albedo / pi times the irradiance of the lights, plus albedo times the world's radiance as far as the ambient
occlusion leaves it open; behind everything, the world itself. The occlusion is brought to full resolution here,
from the half-resolution pixels that show the same surface.
"""

import moderngl

from ....scene import Change
from ...frame import Frame, Pass
from ...gl.render_targets import Target
from ...gl.shader_compiler import bind


class Shade(Pass):
    """The picture of one sample, alpha premultiplied, and what corrects it."""

    reads = (
        *("blocks", "position", "normal", "depth", "albedo"),
        *("irradiance", "predicted", "correction", "smooth_occlusion"),
    )
    writes = {"color": Target(4, "f4"), "color_correction": Target(4, "f4"), "headroom": Target(1, "f4")}
    depends_on = (Change.WORLD, Change.VIEW)

    def draw(self, frame: Frame) -> None:
        self.device.gl.enable_only(moderngl.NOTHING)
        pixels = self.tile_program(occluded=int(frame.occludes))
        bind(
            pixels,
            position=frame.targets["position"],
            normals=frame.targets["normal"],
            depth=frame.targets["depth"],
            albedo=frame.targets["albedo"],
            irradiance=frame.targets["irradiance"],
            predicted=frame.targets["predicted"],
            correction=frame.targets["correction"],
            occlusion=frame.targets["smooth_occlusion"],
            world=tuple(frame.scene.world.radiance),
            background=0.0 if frame.view.transparent else 1.0,
        )
        self.draw_tiles(frame, frame.targets.into(*self.writes), pixels)
