# SPDX-License-Identifier: GPL-3.0-or-later
"""The atrium's lights, world, camera and colour management."""

from collections.abc import Sequence
from contextlib import suppress

import bpy
from mathutils import Vector

WARM = (1.0, 0.64, 0.34)


def add_lights() -> None:
    """A low sun and a soft sky over the roof, lamps in the galleries, a dim blue world."""
    area("Sun", "DISK", (-6.0, 4.4, 17.0), (2.5, -1.5, 0.0), 5400.0, (1.0, 0.87, 0.70), (1.1, 1.1))
    area("Sky", "RECTANGLE", (0.0, 0.6, 10.6), (0.0, -0.3, 0.0), 420.0, (0.78, 0.89, 1.0), (18.0, 5.0))
    area("Lamp, left", "SQUARE", (4.5, 5.8, 3.6), (4.5, 5.6, 0.0), 55.0, WARM, (0.4, 0.4))
    area("Lamp, right", "ELLIPSE", (-1.5, -5.8, 3.6), (-1.5, -5.6, 0.0), 55.0, WARM, (0.6, 0.3))
    area("Lamp, far", "DISK", (13.7, 0.0, 3.6), (13.6, 0.0, 0.0), 55.0, WARM, (0.4, 0.4))
    area("Lamp, upper", "SQUARE", (7.5, -5.8, 8.2), (7.5, -5.6, 4.6), 55.0, WARM, (0.4, 0.4))
    world = bpy.data.worlds.new("Evening sky")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.105, 0.135, 0.19, 1.0)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 1.0
    bpy.context.scene.world = world


def area(
    name: str,
    shape: str,
    position: Sequence[float],
    target: Sequence[float],
    watts: float,
    color: Sequence[float],
    size: tuple[float, float],
) -> None:
    """An area light that shines on a target and is not seen itself."""
    lamp = bpy.data.lights.new(name, "AREA")
    lamp.shape, lamp.energy, lamp.color = shape, watts, color
    lamp.size, lamp.size_y = size
    place = bpy.data.objects.new(name, lamp)
    place.location = position
    place.rotation_euler = aim(position, target)
    place.visible_camera = False
    bpy.context.scene.collection.objects.link(place)


def aim(position: Sequence[float], target: Sequence[float]) -> object:
    """Rotation that lets an object's -z axis point from a position to a target."""
    return (Vector(target) - Vector(position)).to_track_quat("-Z", "Y").to_euler()


def set_up_camera() -> None:
    """The camera at eye height, and a plain view transform that is the same in every Blender."""
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


def set_up_ssao(ssao: bpy.types.PropertyGroup) -> None:
    """The engine's ambient occlusion for a room of this size."""
    ssao.radius, ssao.intensity, ssao.attenuation = 1.5, 2.0, 0.5
