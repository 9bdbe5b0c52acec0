# SPDX-License-Identifier: GPL-3.0-or-later
"""The visibility of each light at each pixel, from the rays of its neighbours on the same surface.

The rays of a neighbourhood go to evenly distributed points of the light. Together they estimate visibility as well as
many rays of one pixel. TraceShadows corrects the prediction; the better it is, the fewer rays that takes.
"""

from collections.abc import Mapping
from functools import cached_property

import moderngl
import numpy as np

from ....resource_types import Resource, Target
from ....resources import (
    ALL_PROBES,
    LIGHT_INFLUENCE,
    NORMAL,
    POSITION,
    PREDICTED_VISIBILITY,
    PREDICTION,
    PREDICTION_SURFACE,
    PROBE,
    PROBE_PREDICTION,
    PROBE_SPACING,
    PROBES,
    RAY_COUNTS,
    REDISCOVERED,
    TILE_SELECTION,
    TILE_SIZE,
    TILE_VISIBILITY,
)
from ....scene import Change
from ...drawing import draw_per_tile, draw_tiles
from ...frame import Frame, Pass, Schedule, outputs
from ...gl import driver_variants
from ...gl.render_targets import create, pixels, size_of
from ...gl.shader_compiler import bind
from ...lights import is_narrow
from ...tiles import PROBES_PER_TILE_SIDE, from_strips, tiles_where

#: Of one light: whether any ray in or near a tile was unoccluded, and whether any was occluded.
RAYS_OF_TILES = Target("rays_of_tiles", "any unoccluded, any occluded", format="rg8", divisor=TILE_SIZE, strips=True)


class PredictVisibility(Pass):
    """For each light that casts shadows, the predicted visibility at each pixel."""

    schedule = Schedule.DOUBLING
    inputs = PROBES, REDISCOVERED, LIGHT_INFLUENCE, POSITION, NORMAL, TILE_SELECTION, Change.SAMPLE
    feedback = (RAY_COUNTS,)
    outputs = outputs(PROBE_PREDICTION, PREDICTION_SURFACE, PREDICTED_VISIBILITY, TILE_VISIBILITY, ALL_PROBES)

    @cached_property
    def probe_program(self) -> moderngl.Program:
        return self.tile_program(suffix="probes", probe_spacing=PROBE_SPACING)

    @cached_property
    def pixel_program(self) -> moderngl.Program:
        return self.tile_program(probe_spacing=PROBE_SPACING)

    @cached_property
    def tile_shader(self) -> moderngl.VertexArray:
        return self.full_screen_program(suffix="tiles", tile_size=TILE_SIZE)

    def needed(self, frame: Frame) -> bool:
        return frame.casts_shadows

    def execute(self, frame: Frame) -> None:
        probes: dict[int, moderngl.Texture]
        all_lights, added = frame[TILE_SELECTION].is_worth_predicting(frame.sample), set[int]()
        if frame.sample == 0:
            visibility, probes, counts = self.first_visibility(frame), dict(frame[PROBES]), {}
        else:
            visibility, probes, counts = dict(frame[TILE_VISIBILITY]), dict(frame[ALL_PROBES]), frame[RAY_COUNTS]
            for light, tiles in self.rays_of_tiles(frame, counts, 1).items() if all_lights else ():
                visibility[light] = visibility[light] | tiles
            added = self.add_rediscovered(frame, visibility, probes)
        if all_lights:
            frame.copy_target(PREDICTION_SURFACE, POSITION)
        predictions = textures_per_light(frame, PREDICTED_VISIBILITY, PREDICTION, visibility)
        for light in visibility if all_lights else added:
            self.predict(frame, visibility[light], probes[light], counts.get(light), predictions[light])
        frame[PREDICTED_VISIBILITY], frame[TILE_VISIBILITY], frame[ALL_PROBES] = predictions, visibility, probes

    def first_visibility(self, frame: Frame) -> dict[int, np.ndarray]:
        """(rows,columns,2) bool by light: any probe unoccluded; any occluded. Only lights that are visible anywhere."""
        visibility = self.rays_of_tiles(frame, frame[PROBES], PROBE_SPACING)
        for light in np.flatnonzero(is_narrow(frame.scene.lights)).tolist():
            if light in visibility:  # it may illuminate points between probes that it does not illuminate
                visibility[light][frame[LIGHT_INFLUENCE][light].to_probe & ~visibility[light].any(2)] = True
        if not frame.settings.shortcuts:
            visibility = {light: np.ones_like(tiles) for light, tiles in visibility.items()}
        return {light: tiles for light, tiles in visibility.items() if tiles[..., 0].any()}

    def add_rediscovered(
        self, frame: Frame, visibility: dict[int, np.ndarray], probes: dict[int, moderngl.Texture]
    ) -> set[int]:
        """Add the lights that became visible by retests, and return them: their tiles, and probes without rays."""
        added = set()
        for light, tiles in frame[REDISCOVERED].items():
            influence = frame[LIGHT_INFLUENCE].get(light)
            if light in visibility or influence is None or not (tiles & ~influence.is_faint).any():
                continue
            visibility[light] = np.stack([tiles, np.ones_like(tiles)], 2)
            probes[light] = create(self.device.gl, PROBE, size_of(PROBE, *frame.size))
            self.device.gl.framebuffer([probes[light]]).clear()
            added.add(light)
        return added

    def rays_of_tiles(self, frame: Frame, rays: Mapping[int, moderngl.Texture], spacing: int) -> dict[int, np.ndarray]:
        """(rows,columns,2) bool by light: any ray in or near a tile unoccluded; any occluded."""
        gl = self.device.gl
        textures = {light: create(gl, RAYS_OF_TILES, size_of(RAYS_OF_TILES, *frame.size)) for light in rays}
        self.device.overwrite()
        for light, texture in textures.items():
            draw_per_tile(frame, gl.framebuffer([texture]), self.tile_shader, rays=rays[light], spacing=spacing)
        self.device.wait()
        return {light: from_strips(pixels(texture), frame.tiles) > 0.0 for light, texture in textures.items()}

    def predict(
        self,
        frame: Frame,
        visibility: np.ndarray,
        probes: moderngl.Texture,
        counts: moderngl.Texture | None,
        prediction: moderngl.Texture,
    ) -> None:
        """Predict a light: 0 or 1 in tiles whose rays agree; in others at probes, then interpolated between them."""
        surfaces = {"position": frame[POSITION], "normal": frame[NORMAL]}
        rays = {"probes": probes, "traced": counts is not None, **({} if counts is None else {"ray_counts": counts})}
        gl, uncertain = self.device.gl, tiles_where(visibility.all(2))
        probe_prediction = frame[PROBE_PREDICTION]
        write_tiles(probe_prediction, size_of(PROBE_PREDICTION, *frame.size), visibility[..., 0], PROBES_PER_TILE_SIDE)
        bind(self.probe_program, **surfaces, **rays)
        draw_tiles(frame, frame.framebuffer(PROBE_PREDICTION), self.probe_program, uncertain, side=PROBES_PER_TILE_SIDE)
        write_tiles(prediction, frame.size, visibility[..., 0], TILE_SIZE)
        bind(self.pixel_program, **surfaces, probe_prediction=probe_prediction)
        draw_tiles(frame, gl.framebuffer([prediction]), self.pixel_program, uncertain)


def textures_per_light(
    frame: Frame, resource: Resource[dict[int, moderngl.Texture]], target: Target, lights: Mapping[int, object]
) -> dict[int, moderngl.Texture]:
    """By light, a texture of the picture's size. Textures of the resource are reused if they have this size."""
    previous, size = frame.get(resource) or {}, driver_variants.sides(frame.size)
    fits = {light: texture for light, texture in previous.items() if texture.size == size}
    return {light: fits[light] if light in fits else create(frame.device.gl, target, frame.size) for light in lights}


def write_tiles(prediction: moderngl.Texture, size: tuple[int, int], visible: np.ndarray, side: int) -> None:
    """Write a certain prediction, visible or occluded, for each tile (rows,columns) bool of `side`×`side` texels."""
    texels = np.zeros((*visible.shape, 2), np.float16)
    texels[..., 0] = visible
    picture = np.ascontiguousarray(texels.repeat(side, 1).repeat(side, 0)[: size[1], : size[0]])
    prediction.write(picture, (0, 0, *size), alignment=1)
