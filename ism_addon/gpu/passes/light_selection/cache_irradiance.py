# SPDX-License-Identifier: GPL-3.0-or-later
"""Irradiance cache (Ward, Rubinstein & Clear 1988) of lights with a light BVH: their irradiance is dear to compute.

At each pixel it is estimated from one node. The cache has the ratio of the irradiance to this estimate at one pixel of
every CACHE_SPACING × CACHE_SPACING: it is near 1 and varies little, so interpolating it adds almost no error. Near the
light it varies much. There the cache has it at each pixel if the light has few triangles. If it has many, rays are
traced there that correct what is interpolated.
"""

from dataclasses import dataclass, replace
from typing import Any, cast

import moderngl
import numpy as np

from ....resources import (
    BASE_COLOR,
    CACHE_CONSTANTS,
    CACHE_SPACING,
    CULLING_STATE,
    IRRADIANCE_CACHE,
    IRRADIANCE_RATIO,
    LIGHT_BUFFERS,
    LIGHT_INFLUENCE,
    MAX_COARSE_RATIO,
    NORMAL,
    POSITION,
    TILE_SELECTION,
    TILE_SIZE,
)
from ....scene import Change
from ...culling.surface_bounds import SurfaceBounds
from ...drawing import draw_pixels, draw_tiles
from ...emission.baked_emission import LIGHT_PIECES
from ...emission.emissive_lights import EmissiveLights
from ...frame import Frame, Pass, Schedule, outputs
from ...gl.render_targets import create, size_of
from ...gl.shader_compiler import bind
from ...gl.shader_records import LIGHT_RECORDS
from ...lights import shader_variant
from ...lights.emissive_mesh import has_light_bvh
from ...tiles import tiles_where

#: Time of a texel, in rays: measured with a ball of 960 triangles, from close by.
RAYS_PER_TEXEL = 16.0

#: Where there is no surface, or a black one, or the light is culled or faint.
NO_RATIO = -1.0

#: Largest ratio at a pixel: float16 holds no larger ones.
MAX_FINE_RATIO = 6e4

#: Maximum number of a light's triangles for which the cache has each pixel near it: there they are seen one by one.
#: LIGHT_PIECES if they differ in radiance.
MAX_NEAR_TRIANGLES = 256

#: A tile is near a light if it is within this multiple of a node's radius of the node, one of so many nodes at most.
NEAR_RADII = 0.5
MAX_NEAR_NODES = 64


@dataclass(frozen=True, eq=False)
class CachedIrradiance:
    """The irradiance cache of one light."""

    texture: moderngl.Texture  # IRRADIANCE_RATIO: a part with a texel for each pixel, and beside it the coarse one
    fine_width: int  # of the former; 0: there is none
    near: np.ndarray  # (rows,columns) bool: tiles near the light; those of the fine part, if there is one

    @property
    def exact(self) -> np.ndarray:
        """(rows,columns) bool: tiles whose irradiance is right without rays."""
        return ~self.near | (self.fine_width > 0)

    @property
    def variant(self) -> int:
        """Constant of shaders that include irradiance_cache.glsl: some drivers execute branches that no pixel takes."""
        return int(CACHE_CONSTANTS["fine_cache"]) if self.fine_width else 1

    @property
    def uniforms(self) -> dict[str, Any]:
        """What shaders that include irradiance_cache.glsl need."""
        return {"irradiance_ratio": self.texture, "fine_width": self.fine_width}


class CacheIrradiance(Pass):
    """For each light with a light BVH that is visible, the ratio of its irradiance to the estimate."""

    schedule = Schedule.DOUBLING  # for lights that were believed occluded, and for the surfaces of PREDICTION_SURFACE
    inputs = (
        *(POSITION, NORMAL, BASE_COLOR, LIGHT_BUFFERS, LIGHT_INFLUENCE, CULLING_STATE, TILE_SELECTION),
        *(Change.LIGHTS, Change.SAMPLE, "shortcuts"),
    )
    outputs = outputs(IRRADIANCE_CACHE)

    def needed(self, frame: Frame) -> bool:
        return bool(has_light_bvh(frame.scene.lights).any())

    def execute(self, frame: Frame) -> None:
        lights = frame.scene.lights
        caches: dict[int, CachedIrradiance] = {} if frame.sample == 0 else dict(frame[IRRADIANCE_CACHE])
        self.device.overwrite()
        has_bvh, draws_fine = has_light_bvh(lights), frame[TILE_SELECTION].is_worth_predicting(frame.sample)
        for light, influence in frame[LIGHT_INFLUENCE].items():
            tiles = influence.contributes & ~influence.is_faint
            visible = tiles & (influence.coarse_visibility > 0.0)
            if light not in caches and has_bvh[light] and visible.any():
                caches[light] = self.coarse(frame, light, tiles, tiles & near_light(frame, light))
            if light in caches and caches[light].fine_width and draws_fine:
                self.draw_fine(frame, light, caches[light])
        frame[IRRADIANCE_CACHE] = caches

    def coarse(self, frame: Frame, light: int, tiles: np.ndarray, near: np.ndarray) -> CachedIrradiance:
        """A light's cache with its coarse part, in tiles (rows,columns) bool, of which some are near the light."""
        gl, columns_and_rows = self.device.gl, np.array(frame.tiles)
        width, height = (texels + 1 for texels in size_of(IRRADIANCE_RATIO, *frame.size))  # to interpolate to the end
        lights = cast(EmissiveLights, frame.scene.lights)  # others have no light BVH
        varies, has_fine = lights.varies[light], near.any() and has_few_triangles(lights, light)
        fine_width, fine_height = (TILE_SIZE * columns_and_rows * has_fine).tolist()
        target = replace(IRRADIANCE_RATIO, format="rgba16f") if varies else IRRADIANCE_RATIO  # and the mean color
        texture = create(gl, target, (fine_width + width, max(fine_height, height)))
        shader = self.full_screen_program(
            *LIGHT_RECORDS, fine=0, tile_size=TILE_SIZE, max_ratio=MAX_COARSE_RATIO, **constants(frame, light)
        )
        needed = gl.texture(frame.tiles, 1, with_next_tiles(tiles).astype(np.uint8) * 255, alignment=1)
        bind(shader.program, **uniforms(frame, light), needed=needed, fine_width=fine_width)
        framebuffer = gl.framebuffer([texture])
        framebuffer.clear(NO_RATIO)
        framebuffer.viewport = fine_width, 0, width, height
        draw_pixels(frame, framebuffer, shader, RAYS_PER_TEXEL)
        return CachedIrradiance(texture, fine_width, near)

    def draw_fine(self, frame: Frame, light: int, cache: CachedIrradiance) -> None:
        """The ratio at each pixel of tiles near the light, of the surfaces in this sample."""
        program = self.tile_program(*LIGHT_RECORDS, fine=1, max_ratio=MAX_FINE_RATIO, **constants(frame, light))
        bind(program, **uniforms(frame, light))
        target = self.device.gl.framebuffer([cache.texture])
        draw_tiles(frame, target, program, tiles_where(cache.near), rays=RAYS_PER_TEXEL)


def constants(frame: Frame, light: int) -> dict[str, Any]:
    """Of the shader for a light."""
    return {"cache_spacing": CACHE_SPACING, "no_ratio": NO_RATIO, **shader_variant(frame.scene.lights, light)}


def uniforms(frame: Frame, light: int) -> dict[str, Any]:
    """The surfaces, and the light."""
    surfaces = {"position": frame[POSITION], "normal": frame[NORMAL], "base_color": frame[BASE_COLOR]}
    return {**surfaces, **frame[LIGHT_BUFFERS], "light_index": light}


def has_few_triangles(lights: EmissiveLights, light: int) -> bool:
    """Whether the cache has each pixel near a light."""
    return bool(lights.triangle_count[light] <= (LIGHT_PIECES if lights.varies[light] else MAX_NEAR_TRIANGLES))


def near_light(frame: Frame, light: int) -> np.ndarray:
    """(rows,columns) bool: tiles near a light with a light BVH, to which rays are traced.

    All tiles, if nothing is known of their surfaces.
    """
    if not frame.traces_shadows:
        return np.zeros(frame.tiles[::-1], bool)
    state = frame.get(CULLING_STATE)
    if state is None:
        return np.ones(frame.tiles[::-1], bool)
    near = near_nodes(state.surfaces, cast(EmissiveLights, frame.scene.lights), light, frame.anchor)
    return near.reshape(-1, *frame.tiles[::-1]).any(0)  # near and far surfaces


def near_nodes(surfaces: SurfaceBounds, lights: EmissiveLights, light: int, anchor: np.ndarray) -> np.ndarray:
    """(N,) bool: surfaces near any of a light's nodes of one depth."""
    count = min(int(lights.leaves[light]), MAX_NEAR_NODES)
    nodes = slice(lights.first_node[light] + count, lights.first_node[light] + 2 * count)
    emits = lights.node_area[nodes] > 0.0
    centres = (lights.node_centre[nodes] - anchor)[emits]
    distances = (1.0 + NEAR_RADII) * lights.node_radius[nodes][emits]
    half = (surfaces.high - surfaces.low) / 2.0
    middle, radius = surfaces.low + half, np.linalg.norm(half, axis=0)
    # Most surfaces are not even near a sphere around all nodes.
    light_centre = centres.mean(0)
    light_distance = (np.linalg.norm(centres - light_centre, axis=1) + distances).max()
    around = np.linalg.norm(middle - light_centre[:, None], axis=0) < light_distance + radius
    rows = np.flatnonzero(surfaces.exists & around)
    near = np.zeros(len(surfaces.exists), bool)
    for centre, distance in zip(centres, distances, strict=True):
        near[rows] |= np.linalg.norm(middle[:, rows] - centre[:, None], axis=0) < distance + radius[rows]
    return near


def with_next_tiles(tiles: np.ndarray) -> np.ndarray:
    """(rows,columns) bool: tiles (rows,columns), and those after them, whose first pixels they interpolate with."""
    near = tiles.copy()
    near[1:] |= tiles[:-1]
    near[:, 1:] |= near[:, :-1].copy()
    return near
