# SPDX-License-Identifier: GPL-3.0-or-later
"""Light and shadow from all light points at each pixel.

Beck-Norén & Valter 2013, section 3.2. What differs: a light's irradiance is exact (Lambert's edge sum, see
radiometry), and the light points only weigh how much of it arrives, as a ratio (Heitz, Hill & McGuire 2018): where
nothing is in the way there is no error. The receiver is compared as the plane that it is, in the direction of
the texel's centre, where the disc was measured too. Matrices come from a table, so their number has no limit.
"""

from functools import cached_property

import moderngl

from ....scene import Change
from ...atlas import NO_OCCLUDER
from ...frame import Frame, Pass
from ...gl.render_targets import Target
from ...gl.shader_compiler import bind
from ...gl.shader_records import LIGHT, MEMBERSHIP, VIRTUAL_LIGHT, VIRTUAL_LIGHT_RANGE

#: Light points that are looked from, or lights, or pixels, in the time of a ray; as measured.
POINTS = 30


class GatherLight(Pass):
    """Irradiance W/m² of each pixel: the sum over the batches of light points."""

    reads = ("position", "normal", "placement", "lights", "points_of_lights", "virtual_lights", "splats", "shadow_maps")
    writes = {"irradiance": Target(4, "f4")}
    settings = ("shadow.enabled", "shadow.method", "shadow.bias", "shadow.fill_holes")
    depends_on = (Change.LIGHTS,)

    @cached_property
    def pixels(self) -> moderngl.VertexArray:
        return self.full_screen_program(LIGHT, VIRTUAL_LIGHT, MEMBERSHIP, VIRTUAL_LIGHT_RANGE, empty=NO_OCCLUDER)

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0 and not frame.fitted

    def draw(self, frame: Frame) -> None:
        frame.counts["lights_used"] = len(frame.tables["points_per_light"])
        gl, batch, shadow = frame.device.gl, frame.batch, frame.settings.shadow
        target = frame.targets.into("irradiance")
        if batch.first == 0:
            target.clear()
        gl.enable_only(moderngl.BLEND)
        gl.blend_func = moderngl.ONE, moderngl.ONE
        bind(
            self.pixels.program,
            position=frame.targets["position"],
            normals=frame.targets["normal"],
            triangles=frame.targets["triangle"],
            memberships=frame.tables["placement"].memberships,
            lights=frame.tables["lights"],
            points_of_lights=frame.tables["points_of_lights"],
            virtual_lights=frame.tables["virtual_lights"],
            maps=frame.targets["shadow_maps" if shadow.fill_holes else "splats"],
            light_count=len(frame.tables["points_per_light"]),
            batch=(batch.first, batch.count),
            side=batch.side,
            columns=batch.columns,
            shadows=frame.casts_shadows,
            bias=shadow.bias,
        )
        points = frame.tables["points_per_light"]
        self.draw_pixels(frame, target, self.pixels, (1 + len(points) + sum(points.values())) / POINTS)
