# SPDX-License-Identifier: GPL-3.0-or-later
"""A ray of ambient occlusion at each pixel. Their distances are kept: other settings count them in other ways."""

from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np

from ....resources import (
    NORMAL,
    POINT_GRAPHS,
    POSITION,
    PRIMITIVE,
    TERMINATOR_OFFSET,
    TILE_SIZE,
    TILES,
    TLAS,
)
from ....resources.world import NO_OCCLUDER_NEAR, OCCLUSION_DISTANCE
from ....sampling.dimensions import Dimension, draw, fixed_increments, fixed_point
from ....scene import Change
from ...drawing import draw_tiles
from ...frame import Frame, Pass, outputs
from ...gl.context import Device
from ...gl.render_targets import create
from ...gl.shader_compiler import bind
from ...gl.shader_records import CASTER, MEMBERSHIP
from ...materials.point_graphs import NO_POINT_GRAPHS
from ...occlusion import traces_occlusion

#: Samples of a tile whose distances are kept, two bytes a pixel each.
SAMPLES_KEPT = 16

#: Time to copy a pixel, in units of the time of a ray.
RAYS_PER_COPY = 0.1


@dataclass(frozen=True)
class Distances:
    """Of one sample of each tile."""

    texture: moderngl.Texture
    tiles: np.ndarray  # (rows,columns) bool: which tiles have any


class TraceOcclusion(Pass):
    """The distance to the nearest surface along a random ray from each pixel."""

    inputs = (
        *(POSITION, NORMAL, PRIMITIVE, TERMINATOR_OFFSET, TLAS, POINT_GRAPHS, TILES),
        *(Change.VIEW, Change.SAMPLE, "ssao.cone_angle"),
    )
    outputs = outputs(OCCLUSION_DISTANCE)

    def __init__(self, device: Device):
        super().__init__(device)
        #: By the pixel grid and the index among a tile's samples, which determine its rays.
        self.kept: dict[tuple[object, int], Distances] = {}
        self.origin: tuple[Any, ...] = ()

    def needed(self, frame: Frame) -> bool:
        is_needed = traces_occlusion(frame)
        if not is_needed:
            self.kept.clear()  # frees memory
        return is_needed

    def execute(self, frame: Frame) -> None:
        self.device.overwrite()
        if self.origin != (origin := self.origin_of(frame)) or not frame.settings.shortcuts:
            self.kept.clear()
            self.origin = origin
        target, tiles = frame.framebuffer(OCCLUSION_DISTANCE), frame[TILES]
        column, row = tiles["tile"].astype(int).T
        index = tiles["sample_index"].astype(int)
        is_known = np.zeros(len(tiles), bool)
        for sample in np.unique(index).tolist():
            kept = self.kept.get((frame.states[Change.PIXEL_GRID], sample))
            if kept is not None:
                known = (index == sample) & kept.tiles[row, column]
                self.copy(frame, kept.texture, target, tiles[known])
                is_known |= known
        self.trace(frame, target, tiles[~is_known])
        for sample in np.unique(index[~is_known]).tolist():
            new = (index == sample) & ~is_known
            if (kept := self.room_for(frame, sample)) is not None:
                into = self.device.gl.framebuffer([kept.texture])
                self.copy(frame, frame[OCCLUSION_DISTANCE], into, tiles[new])
                kept.tiles[row[new], column[new]] = True

    def room_for(self, frame: Frame, sample: int) -> Distances | None:
        """Where the distances of a sample of tiles are kept, or None."""
        key = frame.states[Change.PIXEL_GRID], sample
        if key not in self.kept and len(self.kept) < SAMPLES_KEPT:
            columns, rows = frame.tiles
            texture = create(self.device.gl, OCCLUSION_DISTANCE, frame.size)
            self.kept[key] = Distances(texture, np.zeros((rows, columns), bool))
        return self.kept.get(key)

    def copy(self, frame: Frame, source: moderngl.Texture, into: moderngl.Framebuffer, tiles: np.ndarray) -> None:
        """Copy the distances of some tiles."""
        program = self.tile_program(suffix="copy")
        bind(program, distances=source)
        draw_tiles(frame, into, program, tiles, rays=RAYS_PER_COPY)

    def trace(self, frame: Frame, target: moderngl.Framebuffer, tiles: np.ndarray) -> None:
        """Trace a ray at each pixel of some tiles."""
        surfaces = (frame.get(POINT_GRAPHS) or NO_POINT_GRAPHS).shadow
        constants = {"unoccluded": NO_OCCLUDER_NEAR, **surfaces.constants}
        program = self.tile_program(CASTER, MEMBERSHIP, *surfaces.parts, **constants)
        bind(
            program,
            position=frame[POSITION],
            normal=frame[NORMAL],
            base_color=frame[TERMINATOR_OFFSET],
            **frame[TLAS],
            **surfaces.uniforms,
            pixel_steps=fixed_increments(Dimension.OCCLUSION_RAY, "pixel"),
            first_ray=fixed_point(draw(Dimension.OCCLUSION_RAY, sample=0)),
            ray_steps=fixed_increments(Dimension.OCCLUSION_RAY, "sample"),
            cone_square=np.sin(frame.settings.ssao.cone_angle / 2.0) ** 2,
        )
        draw_tiles(frame, target, program, tiles)
        frame.counts["occlusion_rays"] += len(tiles) * TILE_SIZE**2

    @staticmethod
    def origin_of(frame: Frame) -> tuple[Any, ...]:
        """What the distances of a tile's samples depend on."""
        changes = Change.MESHES, Change.INSTANCES, Change.MATERIALS, Change.VIEW
        return *(frame.states[each] for each in changes), frame.settings.ssao.cone_angle
