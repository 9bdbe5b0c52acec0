# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarse visibility of each light: a shadow ray from one pixel of every 2×2, in the tiles that CullLights selects."""

from ....resources import LIGHT_BUFFERS, LIGHT_INFLUENCE, POINT_GRAPHS, PROBE, PROBE_SPACING, PROBES, TLAS
from ....resources.world import PORTALS
from ....sampling.dimensions import Dimension, draw, fixed_increments
from ....scene import Change
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.render_targets import create, size_of
from ...gl.shader_records import PROBE_BLOCK
from ...surface_inputs import SURFACE
from ...tiles import PROBES_PER_TILE_SIDE, tiles_where
from .probe_rays import ProbeGrid, light_blocks, trace_tiles
from .scene_portals import WEIGHTED_PROBE, portals_of

#: Rays to all lights up to which one program traces them: to compile others would take longer than they save. A first
#: picture of the kitchen of `bench error` takes 0.9 s less so, but rays in its street half as much time again.
MAX_MIXED_RAYS = 1 << 17


class ProbeVisibility(Pass):
    """For each light that casts shadows, whether a ray from one pixel in 2×2 is unoccluded."""

    schedule = Schedule.FIRST
    inputs = *SURFACE, LIGHT_BUFFERS, TLAS, POINT_GRAPHS, LIGHT_INFLUENCE, PORTALS, Change.VIEW, Change.LIGHTS
    outputs = outputs(PROBES)

    def needed(self, frame: Frame) -> bool:
        return frame.casts_shadows

    def execute(self, frame: Frame) -> None:
        gl, casts_shadow = self.device.gl, frame.scene.lights.casts_shadow
        influences = frame[LIGHT_INFLUENCE]
        lights = [light for light, influence in influences.items() if casts_shadow[light] and influence.to_probe.any()]
        size = size_of(PROBE, *frame.size)
        probes = {light: create(gl, WEIGHTED_PROBE if portals_of(frame, light) else PROBE, size) for light in lights}
        self.device.overwrite()
        blocks = PROBE_BLOCK.upload(self.device, light_blocks(lights, draw(Dimension.PROBE_POINT, light=lights)))
        tiles = {light: tiles_where(influences[light].to_probe) for light in lights}
        rays = PROBES_PER_TILE_SIDE**2 * sum(map(len, tiles.values()))
        light_uv_steps = fixed_increments(Dimension.PROBE_POINT, "probe")
        for index, light in enumerate(lights):
            target = gl.framebuffer([probes[light]])
            target.clear()
            grid = ProbeGrid(target.size, PROBE_SPACING, (0, 0), light_uv_steps)
            trace_tiles(frame, target, tiles[light], light, blocks, index, grid, rays > MAX_MIXED_RAYS)
        frame[PROBES] = probes
