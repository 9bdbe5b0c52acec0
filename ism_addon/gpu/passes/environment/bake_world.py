# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluates the graph of a world's radiance in all directions, and makes the tables by which it lights surfaces."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ....color import luminance
from ....resources import MATERIAL_BUFFERS
from ....resources.world import BAKED_WORLD
from ....scene import Change, Scene
from ...buffers.texture_buffer import image_constants
from ...drawing import draw_pixels
from ...environment.map_sun import MapSun, without_sun
from ...environment.map_tables import MapTables
from ...environment.map_texture import with_mip_levels
from ...environment.rotation import without_rotation
from ...frame import Frame, Pass, Schedule, outputs
from ...gl import driver_variants
from ...gl.buffer_texture import SceneRecords
from ...gl.context import Device
from ...gl.shader_compiler import ShaderError, bind
from ...gl.shader_records import IMAGE
from ...lights.world.table import MapLight
from ...materials.shader import glsl

#: Columns of the map: as many as those of the largest image that the graph reads, or twice its rows, in these limits.
MIN_COLUMNS, MAX_COLUMNS = 1024, 2048
#: Points along the sides of the map's texels, of which their radiance is the mean. Images are filtered: between the
#: texels of a map that is as large as its image, one point leaves the same interpolation.
POINTS, IMAGE_POINTS = 2, 1

#: The largest negative radiance, relative to the largest radiance, that nothing is said of: photographs have some.
MAX_NEGATIVE = 0.01


@dataclass(frozen=True, eq=False)
class BakedWorld:
    """The light of a world, and what it was made of."""

    key: tuple[object, ...]  # see key_of
    rotation: np.ndarray  # (3,3), from directions of the world to those of the map
    light: MapLight | None  # in directions of the map; None: the graph cannot be evaluated
    uniforms: dict[str, Any]  # of lights/world/environment.glsl

    @cached_property
    def world_light(self) -> MapLight | None:
        """The light in directions of the world. The same object each time."""
        if self.light is None:
            return None
        sun = self.light.sun
        turned = None if sun is None else replace(sun, direction=sun.direction @ self.rotation)
        return replace(self.light, sun=turned, rotation=self.rotation)


class BakeWorld(Pass):
    """The light of a world whose radiance a graph gives: a map of it, and tables to sample that."""

    schedule = Schedule.FIRST
    inputs = Change.WORLD, Change.MATERIALS, MATERIAL_BUFFERS
    outputs = outputs(BAKED_WORLD)

    def needed(self, frame: Frame) -> bool:
        return bool(frame.scene.world.graph[0] >= 0)

    def execute(self, frame: Frame) -> None:
        graph, last = frame.scene.graphs[frame.scene.world.graph[0]], frame.get(BAKED_WORLD)
        rotation, constants = without_rotation(graph, light_constants(frame.scene))
        key = key_of(frame.scene, constants)
        if last is not None and last.key == key:
            if (last.rotation != rotation).any():
                uniforms = last.uniforms | rotation_uniform(rotation)
                frame[BAKED_WORLD] = replace(last, rotation=rotation, uniforms=uniforms)
            return
        radiance = self.radiance(frame, constants)
        if radiance is None:
            frame[BAKED_WORLD] = BakedWorld(key, rotation, None, {})
            return
        weights = luminance(frame.scene.working_space)
        radiance, sun = without_sun(radiance, weights)
        tables = MapTables.of(radiance, weights)
        uniforms = map_uniforms(self.device, frame.scene_records, radiance, tables, sun)
        uniforms |= rotation_uniform(rotation)
        light = MapLight(tables.peak, sun, tables.leaves, np.eye(3))
        frame[BAKED_WORLD] = BakedWorld(key, rotation, light, uniforms)

    def radiance(self, frame: Frame, numbers: np.ndarray) -> np.ndarray | None:
        """(H,W,3) float32: the map by the graph's constants `numbers`, bottom row first.

        None if the driver cannot compile the graph.
        """
        scene, texels = frame.scene, frame[MATERIAL_BUFFERS].texels
        graph = scene.graphs[scene.world.graph[0]]
        reads_images = graph.uses("image")
        constants: dict[str, Any] = {"points": IMAGE_POINTS if reads_images else POINTS}
        if reads_images:
            constants |= image_constants(scene.images)
        size = map_size(scene)
        try:
            shader = self.full_screen_program(IMAGE, glsl(graph), **constants)
        except ShaderError as error:
            issue = "The graphics driver cannot compile the nodes of the world, which lights evenly"
            frame.warnings.add(f"{issue}: {error}")
            return None
        target = self.device.gl.texture(size, 4, dtype="f4")
        self.device.overwrite()
        bind(
            shader.program,
            map_size=size,
            first_constant=0,
            graph_constants=self.device.buffer_from(numbers),
            **(texels.samplers if reads_images else {}),
        )
        draw_pixels(frame, self.device.gl.framebuffer([target]), shader)
        radiance = np.empty((size[1], size[0], 4), np.float32)
        target.read_into(radiance)
        if -radiance.min() > MAX_NEGATIVE * radiance.max():
            issue = "The world lights nothing where its radiance is negative"
            frame.warnings.add(issue)
        return np.maximum(radiance, 0.0, out=radiance)[..., :3]


def map_uniforms(
    device: Device, records: SceneRecords, radiance: np.ndarray, tables: MapTables, sun: MapSun | None = None
) -> dict[str, Any]:
    """Upload a map (H,W,3), its tables, and the sun that was taken out: uniforms of lights/world/*.glsl."""
    texels = with_mip_levels(radiance, tables.peak)
    texture = device.gl.texture((texels.shape[1], texels.shape[0]), 4, texels, dtype="f2")
    driver_variants.never_filtered(texture)
    irradiance = np.pad(tables.irradiance, ((0, 0), (0, 1)))
    written: dict[str, Any] = {
        f"environment_{name}": records.write(f"environment_{name}", rows.view(np.uint32), 1)
        for name, rows in (("product", tables.product), ("fine", tables.fine), ("irradiance_table", irradiance))
    }
    if sun is not None:
        written["environment_sun"] = records.write("environment_sun", sun_texels(sun), 1)
    return written | {"environment_map": texture, "environment_size": radiance.shape[1::-1]}


def sun_texels(sun: MapSun) -> np.ndarray:
    """(1 + R C,4) uint32: column, row and size of the part of the map, and of its texels what map_sun.glsl reads."""
    texels = np.zeros((1 + sun.radiance.size, 4), np.uint32)
    texels[0] = *sun.first_texel[::-1], *sun.radiance.shape[::-1]
    sums = np.cumsum(sun.probability.ravel(), dtype=np.float64)
    columns = sun.radiance.ravel(), sun.probability.ravel(), sums / sums[-1]
    texels[1:, :3] = np.stack(columns, 1).astype(np.float32).view(np.uint32)
    return texels


def map_size(scene: Scene) -> tuple[int, int]:
    """Columns and rows of the map."""
    columns = [MIN_COLUMNS]
    for index in scene.graphs[scene.world.graph[0]].images(light_constants(scene)):
        height, width = scene.images[index].texels.shape[:2]
        columns += width, 2 * height
    most = min(1 << (max(columns) - 1).bit_length(), MAX_COLUMNS)
    return most, most // 2


def light_constants(scene: Scene) -> np.ndarray:
    """(R,4) float32: the constants of the graph of a world's light."""
    first = int(scene.world.first_constant[0])
    rows: np.ndarray = scene.world.constants[first : first + scene.graphs[scene.world.graph[0]].rows]
    return rows


def key_of(scene: Scene, constants: np.ndarray) -> tuple[object, ...]:
    """What a map and its tables depend on; `constants` (R,4): of the graph without its rotation."""
    graph = scene.graphs[scene.world.graph[0]]
    images = scene.images if graph.uses("image") else ()
    return graph, constants.tobytes(), scene.working_space, *images


def rotation_uniform(rotation: np.ndarray) -> dict[str, Any]:
    """The uniform by which lights/world/*.glsl turn directions to those of the map."""
    return {"environment_rotation": tuple(rotation.T.ravel())}
