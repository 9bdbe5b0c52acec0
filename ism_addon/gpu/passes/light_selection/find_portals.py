# SPDX-License-Identifier: GPL-3.0-or-later
"""Openings that the world's light comes through, if it reaches little of what is visible: see culling/portals.py."""

import math
from typing import Any

import numpy as np

from ....resource_types import Target
from ....resources import LIGHT_BUFFERS, LIGHT_INFLUENCE, NORMAL, POINT_GRAPHS, POSITION, TLAS
from ....resources.world import PORTALS
from ....sampling.dimensions import Dimension, draw, fixed_increments
from ....scene import Change
from ...culling.portal_geometry import Rays
from ...culling.portals import MAX_INDOORS_VISIBILITY, find_portals
from ...drawing import draw_pixels
from ...environment.map_tables import MIN_LEAF
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.render_targets import create, pixels
from ...gl.shader_compiler import bind
from ...gl.shader_records import LIGHT_RECORDS
from ...lights import mixed_variant
from ...lights.world.table import has_world, world_row
from ...surface_inputs import SURFACE
from .probe_rays import ProbeGrid, light_blocks, trace_blocks
from .scene_portals import ScenePortals

#: Rays that look for openings.
PORTAL_RAYS = 40_000

RAY_ORIGIN = Target("ray_origin", "Where rays to the world start; in alpha, the radiance from there", divisor=0)
RAY_DIRECTION = Target("ray_direction", "Their directions; in alpha, whether they were unoccluded", divisor=0)


class FindPortals(Pass):
    """Portals of the world, if rays through them have less variance."""

    schedule = Schedule.FIRST
    inputs = *SURFACE, LIGHT_BUFFERS, TLAS, POINT_GRAPHS, LIGHT_INFLUENCE, Change.LIGHTS, Change.VIEW, "shortcuts"
    outputs = outputs(PORTALS)

    def needed(self, frame: Frame) -> bool:
        return frame.settings.shortcuts and frame.casts_shadows and has_world(frame.scene.lights)

    def execute(self, frame: Frame) -> None:
        world, found = world_row(frame.scene.lights), None
        influence = frame[LIGHT_INFLUENCE].get(world)
        if influence is not None and influence.coarse_visibility[influence.contributes].mean() < MAX_INDOORS_VISIBILITY:
            found = find_portals(self.trace(frame, world))
        shape = int(frame.scene.lights.shape[world])
        frame[PORTALS] = None if found is None else ScenePortals.upload(frame.scene_records, world, shape, found)

    def trace(self, frame: Frame, world: int) -> Rays:
        """Rays to the world from pixels evenly distributed over the picture."""
        gl, spacing = self.device.gl, max(math.isqrt(math.prod(frame.size) // PORTAL_RAYS), 1)
        columns, rows = (-(-side // spacing) for side in frame.size)
        block = light_blocks([world], draw(Dimension.PORTAL_POINT, probe=[0]))
        steps = fixed_increments(Dimension.PORTAL_POINT, "probe")
        grid = ProbeGrid((columns, rows), spacing, (spacing // 2, spacing // 2), steps)
        traced = trace_blocks(frame, block, grid)
        constants: dict[str, Any] = mixed_variant(frame.scene.lights, [world])
        shader = self.full_screen_program(*LIGHT_RECORDS, **constants)
        targets = [create(gl, target, (columns, rows)) for target in (RAY_ORIGIN, RAY_DIRECTION)]
        bind(
            shader.program,
            **frame[LIGHT_BUFFERS],
            world=world,
            position=frame[POSITION],
            normal=frame[NORMAL],
            rays=traced,
            light_uv=tuple(block["light_uv"][0].tolist()),
            spacing=spacing,
            pixel_steps=steps,
        )
        self.device.overwrite()
        draw_pixels(frame, gl.framebuffer(targets), shader)
        self.device.wait()
        origins, directions = (pixels(target)[:rows, :columns].reshape(-1, 4) for target in targets)
        exist = origins[:, 3] > 0.0
        radiance = np.maximum(origins[exist, 3], MIN_LEAF)  # as many rays go to black directions
        return Rays(origins[exist, :3], directions[exist, :3], directions[exist, 3] > 0.5, radiance)
