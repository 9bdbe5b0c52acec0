# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiled light culling: which lights can change which tiles, and by how much. The others are culled.

As in tiled shading (Olsson & Assarsson 2011), a tile's surfaces are bounded by boxes, and their normals by cones: see
culling/surface_bounds.py. A few coarse shadow rays then estimate where each light is visible. A light that may be
occluded is probed by ProbeVisibility if it could be a large fraction of a tile's light, and otherwise by RetestOccluded
in some samples. Lights whose bounds together are negligible in a tile are culled there.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
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
    HIDDEN_LIGHTS,
    LIGHT_BUFFERS,
    LIGHT_INFLUENCE,
    POINT_GRAPHS,
    POSITION,
    RECEIVER_REGION,
    REDISCOVERED,
    RETESTS,
    TILE_MAX,
    TILE_MIN,
    TILE_NORMAL_CONE,
    TILE_SIZE,
    TLAS,
)
from ....sampling.dimensions import Dimension, draw, fixed_increments
from ....scene import Change
from ...culling.culling_state import CullingState, light_influences, neighbourhood
from ...culling.hidden_lights import (
    COARSE_SIDE,
    HiddenLights,
    coarse_tiles_of,
    surfaces_of_coarse_tiles,
)
from ...culling.light_influence import STRONG_FRACTION, UNKNOWN_VISIBILITY, LightInfluence
from ...culling.receiver_region import ReceiverRegion
from ...culling.surface_bounds import SurfaceBounds
from ...drawing import draw_per_tile
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.render_targets import pixels
from ...lights import bounds_with_falloff, by_type, is_narrow
from ...lights.light_type import LightBounds
from ...surface_inputs import SURFACE
from ...tiles import from_strips, repeated
from .probe_rays import ProbeGrid, light_blocks, trace_blocks
from .retests import visible_tiles

#: A tile has two bounding boxes, of near and of far surfaces, if its maximum depth is more than its minimum times this.
DEPTH_SPLIT_RATIO = 1.1

#: Coarse shadow rays start in every FINE_TILE_SPACING-th tile, in x and in y. More than FEW_LIGHTS lights are first
#: tested by a ray from each coarse tile, if there are at least MANY_LIGHTS of these: in a small picture, so few rays
#: would miss visible lights.
FINE_TILE_SPACING = 2
FEW_LIGHTS = 16
MANY_LIGHTS = 64

#: Targets with the bounds of each tile's near surfaces, and of its far ones.
NEAR_BOUNDS = TILE_MIN, TILE_MAX, TILE_NORMAL_CONE
FAR_BOUNDS = FAR_TILE_MIN, FAR_TILE_MAX, FAR_TILE_NORMAL_CONE

#: Pairs of a light and a tile whose bounds are computed at a time. For a thousand lights in the room of
#: tests/scenes/lights/mixed_rooms.py that takes 0.29 s with 1 << 15, 0.19 s with 1 << 17, and 0.23 s with 1 << 19.
PAIRS_AT_A_TIME = 1 << 17


class CullLights(Pass):
    """For each light that contributes anywhere, how much it can in each tile."""

    schedule = Schedule.DOUBLING  # further samples show additional surfaces
    inputs = (
        *(*SURFACE, DEPTH, LIGHT_BUFFERS, TLAS, POINT_GRAPHS),
        *(Change.LIGHTS, Change.GLOSS, Change.SAMPLE, "shortcuts"),
    )
    feedback = (RETESTS,)
    outputs = outputs(
        *(*NEAR_BOUNDS, *FAR_BOUNDS, CULLING_STATE, REDISCOVERED),
        *(LIGHT_INFLUENCE, HIDDEN_LIGHTS, CONTRIBUTING_LIGHTS, RECEIVER_REGION),
    )

    @cached_property
    def surface_bounds(self) -> moderngl.VertexArray:
        return self.full_screen_program(
            tile_size=TILE_SIZE, background_depth=BACKGROUND_DEPTH, depth_split_ratio=DEPTH_SPLIT_RATIO
        )

    def needed(self, frame: Frame) -> bool:
        return len(frame.scene.lights.shape) > 0

    def execute(self, frame: Frame) -> None:
        is_parallel, region = any(light_type.parallel for light_type, *_ in by_type(frame.scene.lights)), None
        frame[REDISCOVERED] = self.rediscovered(frame) if frame.sample > 0 and frame.traces_shadows else {}
        if frame.settings.shortcuts:
            state = self.first_state(frame) if frame.sample == 0 else self.next_state(frame)
            frame[CULLING_STATE] = state
            influences = light_influences(state, frame.scene.has_gloss)
            hidden = state.hidden.lights, state.relative_bounds(np.add)
        else:
            influences, none = without_culling(frame), HiddenLights.none(frame.tiles)
            hidden = none.lights, none.bounds
        if is_parallel:
            region = ReceiverRegion.around(state.surfaces if frame.settings.shortcuts else self.bound_tiles(frame))
        frame[LIGHT_INFLUENCE], frame[HIDDEN_LIGHTS] = influences, hidden
        frame[CONTRIBUTING_LIGHTS] = tuple(sorted(influences))
        frame[RECEIVER_REGION] = region

    def rediscovered(self, frame: Frame) -> dict[int, np.ndarray]:
        """By light, the tiles (rows,columns) bool where any retest since the last doubling was unoccluded."""
        retests = frame.get(RETESTS) or ()
        if retests:
            self.device.wait()
        return visible_tiles(retests, frame.tiles)

    def first_state(self, frame: Frame) -> CullingState:
        """The state after the first sample."""
        surfaces, lights = self.bound_tiles(frame), np.arange(len(frame.scene.lights.shape))
        hidden = HiddenLights.none(frame.tiles)
        if len(lights) > FEW_LIGHTS and frame.traces_shadows and math.prod(coarse_tiles_of(frame.tiles)) >= MANY_LIGHTS:
            lights, hidden = self.bound_coarsely(frame, surfaces)
        bounds, estimates = self.irradiance(frame, lights, surfaces, surfaces.exists)
        visibility = self.probe_coarsely(frame, lights, bounds)
        rows = np.flatnonzero(np.isin(lights, list(visibility)))
        zeros = np.zeros(frame.tiles[::-1])
        irradiance = sum((visibility[int(lights[row])] * estimates[row] for row in rows), zeros)
        state = CullingState(surfaces, lights, bounds, hidden, visibility, neighbourhood(irradiance).mean((2, 3)))
        strong = state.relative_bounds(np.maximum) >= STRONG_FRACTION
        return self.bounded_in_tiles(frame, state, strong.any((1, 2)), {})

    def bound_coarsely(self, frame: Frame, surfaces: SurfaceBounds) -> tuple[np.ndarray, HiddenLights]:
        """Lights (K,) that a ray from any coarse tile reaches, or that cast no shadows; and the hidden ones."""
        coarse, narrow = surfaces_of_coarse_tiles(surfaces, frame.tiles), is_narrow(frame.scene.lights)
        all_lights = np.arange(len(frame.scene.lights.shape))
        bounds, _ = self.irradiance(frame, all_lights, coarse, coarse.exists, COARSE_SIDE)
        bounded = np.flatnonzero(bounds.any((1, 2)))
        probed = bounded[frame.scene.lights.casts_shadow[bounded]]
        if len(probed) <= FEW_LIGHTS:
            return bounded, HiddenLights.none(frame.tiles)
        rays = self.probe_rays(frame, probed, COARSE_SIDE)
        hidden = [light for light in rays if not rays[light][..., 0].any() and (rays[light].any() or not narrow[light])]
        return np.setdiff1d(bounded, hidden), HiddenLights(np.array(hidden, int), bounds[hidden])

    def bounded_in_tiles(
        self, frame: Frame, state: CullingState, chosen: np.ndarray, rediscovered: Mapping[int, np.ndarray]
    ) -> CullingState:
        """The state with the chosen hidden lights (H,) bool bounded in each tile; `rediscovered`: in these tiles."""
        lights, none = state.hidden.lights[chosen], np.zeros(frame.tiles[::-1], bool)
        if not len(lights):
            return state
        bounds, _ = self.irradiance(frame, lights, state.surfaces, state.surfaces.exists)
        visibility = {k: UNKNOWN_VISIBILITY * rediscovered.get(k, none).astype(np.float32) for k in lights.tolist()}
        return replace(
            state,
            lights=np.concatenate([state.lights, lights]),
            bounds=np.concatenate([state.bounds, bounds]),
            hidden=state.hidden.select(~chosen),
            coarse_visibility=state.coarse_visibility | visibility,
        )

    def next_state(self, frame: Frame) -> CullingState:
        """The state updated with the surfaces of this sample and the rediscovered lights."""
        state, visible, narrow = frame[CULLING_STATE], self.bound_tiles(frame), is_narrow(frame.scene.lights)
        rediscovered = frame[REDISCOVERED]
        visibility = dict(state.coarse_visibility)
        for light, influence in frame[LIGHT_INFLUENCE].items():
            visibility[light] = influence.visibility_with(rediscovered.get(light))
        surfaces, grown = state.surfaces.joined(visible), ~state.surfaces.contains(visible)
        bounds = np.maximum(state.bounds, self.irradiance(frame, state.lights, surfaces, grown)[0])
        hidden = state.hidden
        if len(hidden.lights):
            coarse, old = (surfaces_of_coarse_tiles(each, frame.tiles) for each in (surfaces, state.surfaces))
            grown_bounds, _ = self.irradiance(frame, hidden.lights, coarse, ~old.contains(coarse), COARSE_SIDE)
            hidden = HiddenLights(hidden.lights, np.maximum(hidden.bounds, grown_bounds))
        state = CullingState(surfaces, state.lights, bounds, hidden, visibility, state.irradiance)
        state = self.bounded_in_tiles(frame, state, np.isin(hidden.lights, list(rediscovered)), rediscovered)
        for light, rays in self.probe_rays(frame, np.array(list(rediscovered), int), FINE_TILE_SPACING).items():
            found = repeated(neighbourhood_visibility(rays, narrow[light]), FINE_TILE_SPACING, frame.tiles)
            state.coarse_visibility[light] = np.maximum(state.coarse_visibility[light], found)
        return state

    def irradiance(
        self, frame: Frame, lights: np.ndarray, surfaces: SurfaceBounds, chosen: np.ndarray, side: int = 1
    ) -> list[np.ndarray]:
        """Bounds and estimates (K,rows,columns) of lights' (K,) irradiance on surfaces: see LightBounds.

        0 where not chosen, bool. With another `side` than 1, of coarse tiles of side×side tiles.
        """
        columns, rows = (-(-count // side) for count in frame.tiles)
        chosen_surfaces, count = surfaces.select(chosen), int(chosen.sum())
        step = max(PAIRS_AT_A_TIME // max(count, 1), 1)
        irradiance = np.zeros((2, len(lights), rows, columns), np.float32)  # bounds, estimates
        for light_type, indices, type_lights in by_type(frame.scene.lights.select(lights)) if count else ():
            type_bounds = bounds_with_falloff(light_type, type_lights, frame.anchor, frame.scene.working_space)

            def fill(first: int, indices: np.ndarray = indices, bounds: LightBounds = type_bounds) -> None:
                batch = indices[first : first + step]
                near_and_far = np.zeros((2, len(batch), 2, rows * columns), np.float32)
                batch_irradiance = bounds[first : first + step].irradiance(chosen_surfaces)
                near_and_far.reshape(2, -1, 2 * rows * columns)[..., chosen] = batch_irradiance
                irradiance[:, batch] = near_and_far.max(2).reshape(2, -1, rows, columns)

            parallel_map(fill, range(0, len(indices), step), len(indices) * count)
        return list(irradiance)

    def bound_tiles(self, frame: Frame) -> SurfaceBounds:
        """Bounds of the near and of the far surfaces of each tile."""
        targets = *NEAR_BOUNDS, *FAR_BOUNDS
        samplers = {"position": frame[POSITION], "depth": frame[DEPTH]}
        self.device.overwrite()
        draw_per_tile(frame, frame.framebuffer(*targets), self.surface_bounds, **samplers)
        self.device.wait()
        texels = [from_strips(frame.read(target), frame.tiles) for target in targets]
        near_and_far = np.array(texels).reshape(2, 3, -1, 4)
        return SurfaceBounds.of(*near_and_far.swapaxes(0, 1).reshape(3, -1, 4))

    def probe_coarsely(self, frame: Frame, lights: np.ndarray, bounds: np.ndarray) -> dict[int, np.ndarray]:
        """Coarse visibility (rows,columns) by light, of those (K,) whose bounds (K,rows,columns) are not all 0."""
        casts_shadow, narrow = frame.scene.lights.casts_shadow & frame.traces_shadows, is_narrow(frame.scene.lights)
        bounded = lights[bounds.any((1, 2))]
        rays = self.probe_rays(frame, bounded[casts_shadow[bounded]], FINE_TILE_SPACING)
        visible = {light: np.ones(frame.tiles[::-1], np.float32) for light in bounded[~casts_shadow[bounded]].tolist()}
        coarse = {light: neighbourhood_visibility(rays[light], narrow[light]) for light in rays}
        return visible | {k: repeated(coarse[k], FINE_TILE_SPACING, frame.tiles) for k in coarse}

    def probe_rays(self, frame: Frame, lights: np.ndarray, spacing: int) -> dict[int, np.ndarray]:
        """By light, unoccluded and traced rays (H,W,2), one from every `spacing`-th tile in x and in y."""
        columns, rows = (-(-count // spacing) for count in frame.tiles)
        probing, px = 0 if spacing == COARSE_SIDE else frame.sample + 1, spacing * TILE_SIZE
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
            rays_by_light |= zip(batch.tolist(), rays.reshape(len(batch), rows, columns, 2), strict=True)
        return rays_by_light


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
