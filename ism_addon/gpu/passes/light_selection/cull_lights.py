# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiled light culling: which lights can change which tiles, and by how much. The others are culled.

As in tiled shading (Olsson & Assarsson 2011), a tile's surfaces are bounded by boxes, and their normals by cones: see
culling/surface_bounds.py. A few coarse shadow rays then estimate where each light is visible. A light that may be
occluded is probed by ProbeVisibility if it could be a large fraction of a tile's light, and otherwise by RetestOccluded
in some samples. Lights whose bounds together are negligible in a tile are culled there.
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
    LIGHT_BUFFERS,
    LIGHT_INFLUENCE,
    POSITION,
    RECEIVER_REGION,
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
from ...culling.receiver_region import ReceiverRegion
from ...culling.surface_bounds import SurfaceBounds
from ...drawing import draw_per_tile
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.render_targets import pixels
from ...lights import LightBounds, bounds_with_falloff, by_type, is_narrow
from ...surface_inputs import SURFACE
from ...tiles import from_strips
from .probe_rays import ProbeGrid, light_blocks, trace_blocks

# How these were chosen: `dev.py bench constants`, see docs/benchmarks.md.

#: The culled lights of a tile together contribute at most this fraction of its irradiance.
MAX_CULLED_FRACTION = 1e-3

#: For culling, a tile's irradiance counts as at least this fraction of the picture's mean.
MIN_RELATIVE_IRRADIANCE = 0.1

#: A light is faint in a tile if its bound is at most this fraction of the tile's irradiance. It has one prediction per
#: tile.
FAINT_FRACTION = 0.01

#: A tile has two bounding boxes, of near and of far surfaces, if its maximum depth is more than its minimum times this.
DEPTH_SPLIT_RATIO = 1.1

#: Coarse shadow rays start in every FINE_TILE_SPACING-th tile, in x and in y. More than FEW_LIGHTS lights are first
#: tested from every COARSE_TILE_SPACING-th tile, if these are at least MANY_LIGHTS tiles: in a small picture, so few
#: rays would miss visible lights.
FINE_TILE_SPACING = 2
COARSE_TILE_SPACING = 4
FEW_LIGHTS = 16
MANY_LIGHTS = 64

#: Targets with the bounds of each tile's near surfaces, and of its far ones.
NEAR_BOUNDS = TILE_MIN, TILE_MAX, TILE_NORMAL_CONE
FAR_BOUNDS = FAR_TILE_MIN, FAR_TILE_MAX, FAR_TILE_NORMAL_CONE

#: Pairs of a light and a tile whose bounds are computed at a time. For a thousand lights in the room of
#: tests/scenes/lights/mixed_rooms.py that takes 0.29 s with 1 << 15, 0.19 s with 1 << 17, and 0.23 s with 1 << 19.
PAIRS_AT_A_TIME = 1 << 17

#: Bounds are clamped to this multiple of the picture's mean irradiance.
MAX_BOUND_OVER_MEAN = 100.0

FLOAT32_TINY = float(np.finfo(np.float32).tiny)


@dataclass
class CullingState:
    """Bounds and visibility of lights, from all samples so far. Irradiance is a luminance, W/m²."""

    surfaces: SurfaceBounds  # of the visible surfaces of each tile
    bounds: np.ndarray  # (L,rows,columns) float32: upper bounds of each light's irradiance
    coarse_visibility: dict[int, np.ndarray]  # (rows,columns) by light
    irradiance: np.ndarray  # (rows,columns): estimated sum over all lights


class CullLights(Pass):
    """For each light that contributes anywhere, how much it can in each tile."""

    schedule = Schedule.DOUBLING  # further samples show additional surfaces
    inputs = *SURFACE, DEPTH, LIGHT_BUFFERS, TLAS, Change.LIGHTS, Change.SAMPLE, "shortcuts"
    feedback = (REDISCOVERED,)
    outputs = outputs(*NEAR_BOUNDS, *FAR_BOUNDS, CULLING_STATE, LIGHT_INFLUENCE, CONTRIBUTING_LIGHTS, RECEIVER_REGION)

    @cached_property
    def surface_bounds(self) -> moderngl.VertexArray:
        return self.full_screen_program(
            tile_size=TILE_SIZE, background_depth=BACKGROUND_DEPTH, depth_split_ratio=DEPTH_SPLIT_RATIO
        )

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0

    def execute(self, frame: Frame) -> None:
        is_parallel, region = any(light_type.parallel for light_type, *_ in by_type(frame.scene.lights)), None
        if frame.settings.shortcuts:
            state = self.first_state(frame) if frame.sample == 0 else self.next_state(frame)
            frame[CULLING_STATE] = state
            influences = light_influences(state)
        else:
            influences = without_culling(frame)
        if is_parallel:
            region = ReceiverRegion.around(state.surfaces if frame.settings.shortcuts else self.bound_tiles(frame))
        frame[LIGHT_INFLUENCE] = influences
        frame[CONTRIBUTING_LIGHTS] = tuple(sorted(influences))
        frame[RECEIVER_REGION] = region

    def first_state(self, frame: Frame) -> CullingState:
        """The state after the first sample."""
        surfaces = self.bound_tiles(frame)
        bounds, estimates = self.irradiance(frame, surfaces, np.flatnonzero(surfaces.exists))
        visibility = self.probe_coarsely(frame, bounds)
        zeros = np.zeros(frame.tiles[::-1])
        irradiance = sum((visibility[light] * estimates[light] for light in visibility), zeros)
        return CullingState(surfaces, bounds, visibility, neighbourhood(irradiance).mean((2, 3)))

    def next_state(self, frame: Frame) -> CullingState:
        """The state updated with the surfaces of this sample and the rediscovered lights."""
        state, visible, narrow = frame[CULLING_STATE], self.bound_tiles(frame), is_narrow(frame.scene.lights)
        visibility = dict(state.coarse_visibility)
        rediscovered = frame[REDISCOVERED] if frame.traces_shadows else {}
        for light, influence in frame[LIGHT_INFLUENCE].items():
            visibility[light] = influence.visibility_with(rediscovered.get(light))
        for light, rays in self.probe_rays(frame, np.array(list(rediscovered), int), FINE_TILE_SPACING).items():
            coarse = neighbourhood_visibility(rays, narrow[light])
            visibility[light] = np.maximum(visibility[light], self.per_tile(frame, coarse))
        grown = np.flatnonzero(~state.surfaces.contains(visible))
        surfaces = state.surfaces.joined(visible)
        bounds = np.maximum(state.bounds, self.irradiance(frame, surfaces, grown)[0])
        return CullingState(surfaces, bounds, visibility, state.irradiance)

    def irradiance(self, frame: Frame, surfaces: SurfaceBounds, chosen: np.ndarray) -> list[np.ndarray]:
        """Bounds and estimates (L,rows,columns) of lights' irradiance on the chosen surfaces: see LightBounds."""
        chosen_surfaces, lights = surfaces.select(chosen), frame.scene.lights
        step = max(PAIRS_AT_A_TIME // max(len(chosen), 1), 1)
        columns, rows = frame.tiles
        irradiance = np.zeros((2, len(lights.shape), rows, columns), np.float32)  # bounds, estimates
        for light_type, indices, type_lights in by_type(lights):
            type_bounds = bounds_with_falloff(light_type, type_lights, frame.anchor, frame.scene.working_space)

            def fill(first: int, indices: np.ndarray = indices, bounds: LightBounds = type_bounds) -> None:
                batch = indices[first : first + step]
                near_and_far = np.zeros((2, len(batch), 2, rows * columns), np.float32)
                batch_irradiance = bounds[first : first + step].irradiance(chosen_surfaces)
                near_and_far.reshape(2, -1, 2 * rows * columns)[..., chosen] = batch_irradiance
                irradiance[:, batch] = near_and_far.max(2).reshape(2, -1, rows, columns)

            parallel_map(fill, range(0, len(indices), step), len(indices) * len(chosen))
        return list(irradiance)

    def bound_tiles(self, frame: Frame) -> SurfaceBounds:
        """Bounds of the near and of the far surfaces of each tile."""
        targets = *NEAR_BOUNDS, *FAR_BOUNDS
        samplers = {"position": frame[POSITION], "depth": frame[DEPTH]}
        draw_per_tile(frame, frame.framebuffer(*targets), self.surface_bounds, **samplers)
        self.device.wait()
        texels = [from_strips(frame.read(target), frame.tiles) for target in targets]
        near_and_far = np.array(texels).reshape(2, 3, -1, 4)
        return SurfaceBounds.of(*near_and_far.swapaxes(0, 1).reshape(3, -1, 4))

    def probe_coarsely(self, frame: Frame, bounds: np.ndarray) -> dict[int, np.ndarray]:
        """Coarse visibility (rows,columns) by light, if its bounds, of (L,rows,columns), are not 0 everywhere."""
        casts_shadow, narrow = frame.scene.lights.casts_shadow & frame.traces_shadows, is_narrow(frame.scene.lights)
        bounded = np.flatnonzero(bounds.any((1, 2)))
        probed = bounded[casts_shadow[bounded]]
        coarse_tiles = np.prod([-(-count // COARSE_TILE_SPACING) for count in frame.tiles])
        if len(probed) > FEW_LIGHTS and coarse_tiles >= MANY_LIGHTS:
            coarse = self.probe_rays(frame, probed, COARSE_TILE_SPACING)
            is_lit = {light: rays.any() for light, rays in coarse.items()}
            probed = np.array([k for k in probed if coarse[k][..., 0].any() or (narrow[k] and not is_lit[k])], int)
        rays = self.probe_rays(frame, probed, FINE_TILE_SPACING)
        unprobed = {
            light: np.full(frame.tiles[::-1], 0.0 if casts_shadow[light] else 1.0, np.float32)
            for light in bounded.tolist()
        }
        return unprobed | {k: self.per_tile(frame, neighbourhood_visibility(rays[k], narrow[k])) for k in rays}

    @staticmethod
    def per_tile(frame: Frame, values: np.ndarray) -> np.ndarray:
        """Values of every FINE_TILE_SPACING-th tile, repeated to all tiles (rows,columns)."""
        columns, rows = frame.tiles
        return values.repeat(FINE_TILE_SPACING, 0).repeat(FINE_TILE_SPACING, 1)[:rows, :columns]

    def probe_rays(self, frame: Frame, lights: np.ndarray, spacing: int) -> dict[int, np.ndarray]:
        """By light, unoccluded and traced rays (H,W,2), one from every `spacing`-th tile in x and in y."""
        columns, rows = (-(-count // spacing) for count in frame.tiles)
        probing, px = 0 if spacing == COARSE_TILE_SPACING else frame.sample + 1, spacing * TILE_SIZE
        blocks = light_blocks(lights, draw(Dimension.CULLING_POINT, light=lights, probing=probing))
        light_uv_steps = fixed_increments(Dimension.CULLING_POINT, "culling_tile")
        grid = ProbeGrid((columns, rows), px, (px // 2, px // 2), light_uv_steps)
        step = self.device.texture_size // rows
        rays_by_light: dict[int, np.ndarray] = {}
        for first in range(0, len(lights), step):
            batch = lights[first : first + step]
            texture = trace_blocks(frame, blocks[first : first + step], grid)
            self.device.wait()
            rays = pixels(texture)[: len(batch) * rows, :columns]
            rays_by_light |= zip(batch, rays.reshape(len(batch), rows, columns, 2), strict=True)
        return rays_by_light


def light_influences(state: CullingState) -> dict[int, LightInfluence]:
    """By light, its influence on the tiles, for all lights that contribute to any tile."""
    exists, influences = state.surfaces.exists.reshape(2, *state.irradiance.shape).any(0), {}
    mean = max(float(state.irradiance[exists].mean()) if exists.any() else 0.0, FLOAT32_TINY)
    local, culled = np.maximum(state.irradiance, MIN_RELATIVE_IRRADIANCE * mean), np.zeros_like(state.irradiance)
    bounds = with_edges(state.bounds, exists)
    tile_irradiance, hidden = np.maximum(state.irradiance, mean), np.zeros_like(bounds, bool)
    for light, visibility in state.coarse_visibility.items():
        hidden[light] = visibility == 0.0
    # Of many lights that are hidden, one is a small part: together they are probed and retested as if they were one.
    hidden_bound = np.maximum((bounds * hidden).sum(0), tile_irradiance)
    for light in np.argsort(np.tensordot(bounds, 1.0 / tile_irradiance)):  # faintest first
        bound = bounds[light]
        culled += bound
        contributes = (bound > 0.0) & (culled > MAX_CULLED_FRACTION * local)
        if contributes.any():
            influences[int(light)] = LightInfluence(
                contributes=contributes,
                bound_over_faint=np.minimum(bound / np.maximum(FAINT_FRACTION * local, FLOAT32_TINY), 1.0),
                relative_bound=np.minimum(bound / np.where(hidden[light], hidden_bound, tile_irradiance), 1.0),
                bound_over_mean=np.minimum(bound, MAX_BOUND_OVER_MEAN * mean) / mean,
                coarse_visibility=state.coarse_visibility.get(int(light), np.zeros_like(bound)),
            )
    return influences


def with_edges(bounds: np.ndarray, exists: np.ndarray) -> np.ndarray:
    """Bounds (L,rows,columns); in tiles without surfaces, the greatest of their neighbours.

    In a later sample the edge of a neighbour's surface may be in such a tile.
    """
    row, column = np.nonzero(neighbourhood(exists).any((2, 3)) & ~exists)
    if not len(row):
        return bounds
    rows, columns = (
        np.clip(index + np.arange(-1, 2)[:, None], 0, size - 1)
        for index, size in zip((row, column), exists.shape, strict=True)
    )
    filled = bounds.copy()
    filled[:, row, column] = np.max([bounds[:, y, x] for y in rows for x in columns], 0)
    return filled


def without_culling(frame: Frame) -> dict[int, LightInfluence]:
    """All lights contribute to all tiles."""
    ones = np.ones(frame.tiles[::-1], np.float32)
    return {light: LightInfluence(ones > 0.0, ones, ones, ones, ones) for light in range(len(frame.scene.lights.shape))}


def neighbourhood_visibility(rays: np.ndarray, narrow: bool) -> np.ndarray:
    """(H,W) visibility, from unoccluded and traced rays (H,W,2) in 3×3 neighbourhoods.

    A `narrow` light may illuminate points between rays that it does not illuminate: there its visibility is unknown.
    """
    unoccluded, traced = (neighbourhood(count).sum((2, 3)) for count in np.moveaxis(rays, 2, 0))
    return np.where(narrow & (traced == 0.0), UNKNOWN_VISIBILITY, unoccluded / np.maximum(traced, 1.0))


def neighbourhood(values: np.ndarray) -> np.ndarray:
    """(H,W,3,3): 3×3 neighbourhoods of (H,W). Values at the border are repeated beyond it."""
    return np.lib.stride_tricks.sliding_window_view(np.pad(values, 1, mode="edge"), (3, 3))
