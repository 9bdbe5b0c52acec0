# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiled light culling: which lights can change which tiles, and by how much. The others are left out.

As in tiled shading (Olsson & Assarsson 2011), a tile's surfaces are bounded by boxes, and their normals by cones, see
`surface_bounds`. A few coarse shadow rays then tell which lights arrive at all. A light that may be hidden is probed by
ProbeVisibility if it could be a large part of a tile's light, and by RetestOccluded now and then if not. Lights that
are negligible in a tile, all of them together, are left out for good.
"""

from dataclasses import dataclass
from functools import cached_property

import moderngl
import numpy as np

from ....parallel import parallel_map
from ....resources import (
    BACKGROUND_DEPTH,
    CONTRIBUTING_LIGHTS,
    CULLING_STATE,
    DEPTH,
    FAR_TILE_MAX,
    FAR_TILE_MIN,
    FAR_TILE_NORMAL_CONE,
    LIGHT_BUFFER,
    LIGHT_INFLUENCE,
    POSITION,
    REDISCOVERED,
    TILE_MAX,
    TILE_MIN,
    TILE_NORMAL_CONE,
    TILE_SIZE,
    TLAS,
)
from ....sampling.dimensions import Dimension, draw, fixed_increments
from ....scene import Change
from ...culling.light_influence import UNKNOWN_VISIBILITY, LightInfluence
from ...culling.surface_bounds import SurfaceBounds
from ...drawing import draw_per_tile
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.render_targets import pixels
from ...lights import LightBounds, by_type, is_narrow
from ...surface_inputs import SURFACE
from ...tiles import from_strips
from .probe_rays import ProbeGrid, light_blocks, trace_blocks

#: Lights that bring less than this part of a block's light, all together, are left out there. Blocks are not taken
#: for darker than this part of the picture's mean.
MAX_CULLED_FRACTION = 1e-3
MIN_RELATIVE_IRRADIANCE = 0.1

#: A light that may bring no more than this part of a block's light is predicted for the block as a whole.
FAINT_FRACTION = 0.01

#: What a block shows is bounded in two parts, near and far, if the farthest depth is the nearest times this.
DEPTH_SPLIT_RATIO = 1.1

#: Lights are looked for from one block of so many, along either side of the picture; of more lights than a few, only
#: those that arrive at any of fewer blocks, where these are many: a small picture's would leave out what they miss.
FINE_TILE_SPACING = 2
COARSE_TILE_SPACING = 4
FEW_LIGHTS = 16
MANY_LIGHTS = 64

#: What bounds a tile: of near surfaces, then of far ones.
NEAR_BOUNDS = TILE_MIN, TILE_MAX, TILE_NORMAL_CONE
FAR_BOUNDS = FAR_TILE_MIN, FAR_TILE_MAX, FAR_TILE_NORMAL_CONE

#: Pairs of a light and a block that are weighed at a time: as many as processors keep close at hand.
PAIRS_AT_A_TIME = 1 << 15

#: So many times the picture's mean light is as bright as any.
MAX_BOUND_OVER_MEAN = 100.0

FLOAT32_TINY = float(np.finfo(np.float32).tiny)


@dataclass
class CullingState:
    """What all samples so far say of lights. The luminance of irradiance is in W/m²."""

    surfaces: SurfaceBounds  # of all that tiles have shown
    bounds: np.ndarray  # (L,rows,columns) float32: upper bounds of the luminance of each light's irradiance there
    coarse_visibility: dict[int, np.ndarray]  # (rows,columns) by light
    irradiance: np.ndarray  # (rows,columns): the luminance that is believed to arrive


class CullLights(Pass):
    """For each light that contributes anywhere, how much it can in each tile."""

    schedule = Schedule.DOUBLING  # surfaces come to light
    inputs = *SURFACE, DEPTH, LIGHT_BUFFER, TLAS, Change.LIGHTS, Change.SAMPLE, "shortcuts"
    feedback = (REDISCOVERED,)
    outputs = outputs(*NEAR_BOUNDS, *FAR_BOUNDS, CULLING_STATE, LIGHT_INFLUENCE, CONTRIBUTING_LIGHTS)

    @cached_property
    def surface_bounds(self) -> moderngl.VertexArray:
        return self.full_screen_program(
            tile_size=TILE_SIZE, background_depth=BACKGROUND_DEPTH, depth_split_ratio=DEPTH_SPLIT_RATIO
        )

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0

    def execute(self, frame: Frame) -> None:
        if frame.settings.shortcuts:
            state = self.first_state(frame) if frame.sample == 0 else self.next_state(frame)
            frame[CULLING_STATE] = state
            influences = light_influences(state)
        else:
            influences = without_culling(frame)
        frame[LIGHT_INFLUENCE] = influences
        frame[CONTRIBUTING_LIGHTS] = tuple(sorted(influences))

    def first_state(self, frame: Frame) -> CullingState:
        """By what the first sample shows."""
        surfaces = self.bound_tiles(frame)
        bounds, estimates = self.irradiance(frame, surfaces, np.flatnonzero(surfaces.exists))
        visibility = self.probe_coarsely(frame, bounds)
        none = np.zeros(frame.tiles[::-1])
        arriving = sum((visibility[light] * estimates[light] for light in visibility), none)
        return CullingState(surfaces, bounds, visibility, neighbourhood(arriving).mean((2, 3)))

    def next_state(self, frame: Frame) -> CullingState:
        """By all that was seen so far."""
        state, shown, narrow = frame[CULLING_STATE], self.bound_tiles(frame), is_narrow(frame.scene.lights)
        visibility = dict(state.coarse_visibility)
        rediscovered = frame[REDISCOVERED] if frame.traces_shadows else {}
        for light, influence in frame[LIGHT_INFLUENCE].items():
            visibility[light] = influence.visibility_with(rediscovered.get(light))
        for light, rays in self.probe_rays(frame, np.array(list(rediscovered), int), FINE_TILE_SPACING).items():
            found = neighbourhood_visibility(rays, narrow[light])
            visibility[light] = np.maximum(visibility[light], self.per_tile(frame, found))
        new = np.flatnonzero(~state.surfaces.contains(shown))
        surfaces = state.surfaces.joined(shown)
        bounds = np.maximum(state.bounds, self.irradiance(frame, surfaces, new)[0])
        return CullingState(surfaces, bounds, visibility, state.irradiance)

    def irradiance(self, frame: Frame, surfaces: SurfaceBounds, which: np.ndarray) -> list[np.ndarray]:
        """Arrays (L,rows,columns) of bounds and of estimates, for some surfaces: see LightBounds."""
        some, lights = surfaces.select(which), frame.scene.lights
        step = max(PAIRS_AT_A_TIME // max(len(which), 1), 1)
        columns, rows = frame.tiles
        found = np.zeros((2, len(lights.shape), rows, columns), np.float32)
        for light_type, indices, own in by_type(lights):
            bounds = light_type.bounds(own, frame.anchor, frame.scene.working_space)

            def fill(first: int, indices: np.ndarray = indices, bounds: LightBounds = bounds) -> None:
                part = indices[first : first + step]
                near_and_far = np.zeros((2, len(part), 2, rows * columns), np.float32)
                irradiance = bounds[first : first + step].irradiance(some)
                near_and_far.reshape(2, -1, 2 * rows * columns)[..., which] = irradiance
                found[:, part] = near_and_far.max(2).reshape(2, -1, rows, columns)

            parallel_map(fill, range(0, len(indices), step), len(indices) * len(which))
        return list(found)

    def bound_tiles(self, frame: Frame) -> SurfaceBounds:
        """What the tiles show, each nearby and far off."""
        targets = *NEAR_BOUNDS, *FAR_BOUNDS
        shown = {"position": frame[POSITION], "depth": frame[DEPTH]}
        draw_per_tile(frame, frame.framebuffer(*targets), self.surface_bounds, **shown)
        self.device.wait()
        found = [from_strips(frame.read(target), frame.tiles) for target in targets]
        near_and_far = np.array(found).reshape(2, 3, -1, 4)
        return SurfaceBounds.of(*near_and_far.swapaxes(0, 1).reshape(3, -1, 4))

    def probe_coarsely(self, frame: Frame, bounds: np.ndarray) -> dict[int, np.ndarray]:
        """(rows,columns) of each light whose bound (L,rows,columns) is above 0 anywhere: visibility about a tile."""
        casts, narrow = frame.scene.lights.casts_shadow & frame.traces_shadows, is_narrow(frame.scene.lights)
        reaching = np.flatnonzero(bounds.any((1, 2)))
        probed = reaching[casts[reaching]]
        coarse_tiles = np.prod([-(-count // COARSE_TILE_SPACING) for count in frame.tiles])
        if len(probed) > FEW_LIGHTS and coarse_tiles >= MANY_LIGHTS:
            arrived = self.probe_rays(frame, probed, COARSE_TILE_SPACING)
            sent = {light: rays.any() for light, rays in arrived.items()}
            probed = np.array([k for k in probed if arrived[k][..., 0].any() or (narrow[k] and not sent[k])], int)
        rays = self.probe_rays(frame, probed, FINE_TILE_SPACING)
        certain = {
            light: np.full(frame.tiles[::-1], 0.0 if casts[light] else 1.0, np.float32) for light in reaching.tolist()
        }
        return certain | {k: self.per_tile(frame, neighbourhood_visibility(rays[k], narrow[k])) for k in rays}

    @staticmethod
    def per_tile(frame: Frame, found: np.ndarray) -> np.ndarray:
        """(rows,columns) for each tile, of what rays from every FINE_TILE_SPACING-th have found."""
        columns, rows = frame.tiles
        return found.repeat(FINE_TILE_SPACING, 0).repeat(FINE_TILE_SPACING, 1)[:rows, :columns]

    def probe_rays(self, frame: Frame, lights: np.ndarray, spacing: int) -> dict[int, np.ndarray]:
        """(rows,columns,2) of each light: rays that arrived from every tile, or each so far apart, and rays."""
        columns, rows = (-(-count // spacing) for count in frame.tiles)
        probing, px = 0 if spacing == COARSE_TILE_SPACING else frame.sample + 1, spacing * TILE_SIZE
        blocks = light_blocks(lights, draw(Dimension.CULLING_POINT, light=lights, probing=probing))
        light_uv_steps = fixed_increments(Dimension.CULLING_POINT, "culling_tile")
        grid = ProbeGrid((columns, rows), px, (px // 2, px // 2), light_uv_steps)
        step = self.device.texture_size // rows
        found: dict[int, np.ndarray] = {}
        for first in range(0, len(lights), step):
            some = lights[first : first + step]
            texture = trace_blocks(frame, blocks[first : first + step], grid)
            self.device.wait()
            rays = pixels(texture)[: len(some) * rows, :columns]
            found |= zip(some, rays.reshape(len(some), rows, columns, 2), strict=True)
        return found


def light_influences(state: CullingState) -> dict[int, LightInfluence]:
    """Which lights contribute where, by the most that each can bring."""
    shown, found = state.surfaces.exists.reshape(2, *state.irradiance.shape).any(0), {}
    mean = max(float(state.irradiance[shown].mean()) if shown.any() else 0.0, FLOAT32_TINY)
    local, left_out = np.maximum(state.irradiance, MIN_RELATIVE_IRRADIANCE * mean), np.zeros_like(state.irradiance)
    relative_bounds = state.bounds / np.maximum(state.irradiance, mean)
    for light in np.argsort(relative_bounds.sum((1, 2))):  # the faintest first
        bound = state.bounds[light]
        left_out += bound
        contributes = (bound > 0.0) & (left_out > MAX_CULLED_FRACTION * local)
        if contributes.any():
            found[int(light)] = LightInfluence(
                contributes=contributes,
                bound_over_faint=np.minimum(bound / np.maximum(FAINT_FRACTION * local, FLOAT32_TINY), 1.0),
                relative_bound=np.minimum(relative_bounds[light], 1.0),
                bound_over_mean=np.minimum(bound, MAX_BOUND_OVER_MEAN * mean) / mean,
                coarse_visibility=state.coarse_visibility.get(int(light), np.zeros_like(bound)),
            )
    return found


def without_culling(frame: Frame) -> dict[int, LightInfluence]:
    """As if all lights contributed to all tiles."""
    ones = np.ones(frame.tiles[::-1], np.float32)
    return {light: LightInfluence(ones > 0.0, ones, ones, ones, ones) for light in range(len(frame.scene.lights.shape))}


def neighbourhood_visibility(rays: np.ndarray, narrow: bool) -> np.ndarray:
    """(H,W): of rays (H,W,2), those that arrived and all, the part that arrived among each one and its neighbours.

    A light's `narrow` cone may light what lies between points that it sends nothing to.
    """
    arrived, sent = (neighbourhood(number).sum((2, 3)) for number in np.moveaxis(rays, 2, 0))
    return np.where(narrow & (sent == 0.0), UNKNOWN_VISIBILITY, arrived / np.maximum(sent, 1.0))


def neighbourhood(values: np.ndarray) -> np.ndarray:
    """(H,W,3,3): each one of (H,W) and its eight neighbours; beyond the border, those at it."""
    return np.lib.stride_tricks.sliding_window_view(np.pad(values, 1, mode="edge"), (3, 3))
