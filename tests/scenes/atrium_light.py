# SPDX-License-Identifier: GPL-3.0-or-later
"""The atrium's lights, world, camera and colour management."""

from collections.abc import Sequence
from contextlib import suppress

import bpy
from mathutils import Vector

WARM = (1.0, 0.64, 0.34)


def add_lights() -> None:
    """Add area lights for a low sun, for the sky above the roof and in the galleries, and a dim blue world."""
    add_area_light("Sun", "DISK", (-6.0, 4.4, 17.0), (2.5, -1.5, 0.0), 5400.0, (1.0, 0.87, 0.70), (1.1, 1.1))
    add_area_light("Sky", "RECTANGLE", (0.0, 0.6, 10.6), (0.0, -0.3, 0.0), 420.0, (0.78, 0.89, 1.0), (18.0, 5.0))
    add_area_light("Lamp, left", "SQUARE", (4.5, 5.8, 3.6), (4.5, 5.6, 0.0), 55.0, WARM, (0.4, 0.4))
    add_area_light("Lamp, right", "ELLIPSE", (-1.5, -5.8, 3.6), (-1.5, -5.6, 0.0), 55.0, WARM, (0.6, 0.3))
    add_area_light("Lamp, far", "DISK", (13.7, 0.0, 3.6), (13.6, 0.0, 0.0), 55.0, WARM, (0.4, 0.4))
    add_area_light("Lamp, upper", "SQUARE", (7.5, -5.8, 8.2), (7.5, -5.6, 4.6), 55.0, WARM, (0.4, 0.4))
    world = bpy.data.worlds.new("Evening sky")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.105, 0.135, 0.19, 1.0)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 1.0
    bpy.context.scene.world = world


def add_area_light(
    name: str,
    shape: str,
    position: Sequence[float],
    target: Sequence[float],
    watts: float,
    color: Sequence[float],
    size: tuple[float, float],
) -> None:
    """Add an area light aimed at a target. The camera does not see it."""
    data = bpy.data.lights.new(name, "AREA")
    data.shape, data.energy, data.color = shape, watts, color
    data.size, data.size_y = size
    light_object = bpy.data.objects.new(name, data)
    light_object.location = position
    light_object.rotation_euler = aim(position, target)
    light_object.visible_camera = False
    bpy.context.scene.collection.objects.link(light_object)


def aim(position: Sequence[float], target: Sequence[float]) -> object:
    """The rotation that makes an object's -z axis point from a position to a target."""
    return (Vector(target) - Vector(position)).to_track_quat("-Z", "Y").to_euler()


def set_up_camera() -> None:
    """Add the camera at eye height, and set a view transform that is the same in every Blender version."""
    scene = bpy.context.scene
    lens = bpy.data.cameras.new("Camera")
    lens.lens = 21.0
    lens.clip_start, lens.clip_end = 0.05, 200.0
    camera = bpy.data.objects.new("Camera", lens)
    camera.location = (-10.8, -1.0, 1.75)
    camera.rotation_euler = aim(camera.location, (2.0, 0.25, 2.95))
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 1280, 720, 100
    scene.view_settings.view_transform, scene.view_settings.look = "Standard", "None"
    scene.view_settings.exposure, scene.view_settings.gamma = 0.0, 1.0
    with suppress(TypeError):  # the add-on is not registered: Blender's default engine stays
        scene.render.engine = "ISM"


def set_up_occlusion(ism: bpy.types.PropertyGroup) -> None:
    """As in the report, ambient occlusion darkens the world's light; it is set for a building of this size."""
    ism.shadow.world, ssao = False, ism.ssao
    ssao.sampling, ssao.radius, ssao.intensity, ssao.attenuation = "POINTS", 1.5, 2.0, 0.5
