# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scripts of the benchmark's .blend files share: a black world, area lights, a camera, large meshes.

Materials are Lambertian and all light comes from area lights, so that Cycles without bounces renders the reference.
"""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from tests.tools.new_file import open_empty_file

from .atrium_light import aim

Point = tuple[float, float, float]

WHITE: Point = (1.0, 1.0, 1.0)
WARM: Point = (1.0, 0.72, 0.46)
COOL: Point = (0.62, 0.78, 1.0)
SIZE = 640, 360  # px


@dataclass(frozen=True)
class AreaLight:
    """An area light at a position, aimed at a target. The camera does not see it."""

    shape: str  # as Blender names it
    position: Point  # m
    target: Point  # m
    watts: float
    size: tuple[float, float]  # m
    color: Point = WHITE
    spread: float = 180.0  # degrees


def new_file() -> None:
    """Open an empty file with a black world."""
    open_empty_file()
    set_black_world()


def set_black_world() -> None:
    """Give the open file a world that emits no light."""
    world = bpy.data.worlds.new("Night")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    bpy.context.scene.world = world


def add_lights(lights: Sequence[AreaLight]) -> None:
    """Add area lights to the open scene."""
    for index, light in enumerate(lights, 1):
        data = bpy.data.lights.new(f"Lamp {index}", "AREA")
        data.shape, data.energy, data.color = light.shape, light.watts, light.color
        data.size, data.size_y = light.size
        data.spread = math.radians(light.spread)
        light_object = bpy.data.objects.new(data.name, data)
        light_object.location, light_object.rotation_euler = light.position, aim(light.position, light.target)
        light_object.visible_camera = False
        bpy.context.scene.collection.objects.link(light_object)


def add_camera(position: Point, target: Point, lens: float) -> None:
    """Add the camera, its lens in millimetres, and set a view transform that is the same in every Blender version."""
    scene = bpy.context.scene
    data = bpy.data.cameras.new("Camera")
    data.lens, data.clip_start, data.clip_end = lens, 0.01, 500.0
    scene.camera = bpy.data.objects.new("Camera", data)
    scene.camera.location, scene.camera.rotation_euler = position, aim(position, target)
    scene.collection.objects.link(scene.camera)
    scene.view_settings.view_transform, scene.view_settings.look = "Standard", "None"


def save(path: Path) -> None:
    """Save the open file, with the benchmark's resolution."""
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.render.resolution_percentage = 100
    with suppress(TypeError):  # the add-on is not registered: Blender's default engine stays
        scene.render.engine = "ISM"
    bpy.context.preferences.filepaths.save_version = 0
    bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True)


def large_mesh(name: str, positions: np.ndarray, quads: np.ndarray, material: bpy.types.Material) -> bpy.types.Mesh:
    """A smooth mesh of positions (V,3) and quads (F,4). It is copied as arrays: it may have a million triangles."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", positions.astype(np.float32).ravel())
    mesh.loops.add(quads.size)
    mesh.loops.foreach_set("vertex_index", quads.astype(np.int32).ravel())
    mesh.polygons.add(len(quads))
    mesh.polygons.foreach_set("loop_start", np.arange(0, quads.size, 4, dtype=np.int32))
    mesh.update(calc_edges=True)
    mesh.materials.append(material)
    mesh.shade_smooth()
    return mesh
