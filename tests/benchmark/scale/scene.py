# SPDX-License-Identifier: GPL-3.0-or-later
"""The scale benchmark's scene: rough ground, a rock, balls and area lights, in any number."""

import math

import bpy
import numpy as np

from tests.scenes import blend_file
from tests.scenes.atrium_light import aim
from tests.scenes.blend_file import AreaLight, large_mesh
from tests.scenes.parts.solids import ball

HALF_WIDTH = 4.0  # m, half of the ground's side
HEIGHT = 5.0  # m, of the lights
WATTS = 300.0  # of all lights together
CAMERA = (0.0, -6.5, 3.2), (0.0, 0.2, 0.4), 34.0
SENSOR = 36.0  # mm, Blender's default
SHAPES = ("RECTANGLE", "ELLIPSE", "SQUARE", "DISK")


def build(triangles: int, objects: int, lights: int) -> None:
    """Open the scene: `triangles` in ground and rock together, `objects` balls, `lights` area lights."""
    blend_file.new_file()
    material = bpy.data.materials.new("Stone")
    add_object("Ground", ground(triangles // 2, material))
    solid = ball(1.0, max(round(math.sqrt(triangles / 24)), 2), 2.6)
    add_object("Rock", large_mesh("Rock", displaced(solid.positions) * 0.9 + (0.2, 0.3, 0.9), solid.quads, material))
    small = ball(1.0, 4)
    scatter(large_mesh("Ball", small.positions, small.quads, material), objects)
    blend_file.add_lights(ring_of_lights(lights))
    blend_file.add_camera(*CAMERA)


def ground(triangles: int, material: bpy.types.Material) -> bpy.types.Mesh:
    """Ground with waves and smaller bumps."""
    line = np.linspace(-HALF_WIDTH, HALF_WIDTH, max(round(math.sqrt(triangles / 2)), 1) + 1, dtype=np.float32)
    positions = np.empty((len(line), len(line), 3), np.float32)
    positions[..., 0], positions[..., 1] = line[:, None], line
    positions[..., 2] = 0.15 * np.sin(2.1 * line)[:, None] * np.cos(1.7 * line)
    positions[..., 2] += 0.03 * np.sin(17.0 * line)[:, None] * np.sin(13.0 * line)
    index = np.arange(len(line) ** 2, dtype=np.int32).reshape(len(line), -1)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1)
    return large_mesh("Ground", positions.reshape(-1, 3), quads.reshape(-1, 4), material)


def displaced(directions: np.ndarray) -> np.ndarray:
    """Points (N,3) of a ball, displaced by bumps."""
    x, y, z = directions.T
    bumps = 0.08 * np.sin(5.0 * x + 2.0 * z) * np.sin(4.0 * y) + 0.015 * np.sin(31.0 * z) * np.sin(29.0 * (x + y))
    return directions * (1.0 + bumps)[:, None]


def scatter(mesh: bpy.types.Mesh, count: int) -> None:
    """Add instances of a ball of radius 1 to the ground. The more there are, the smaller they are."""
    random = np.random.default_rng(count)
    size = 0.9 / math.sqrt(max(count, 9))
    for index, (x, y) in enumerate(random.uniform(-0.85 * HALF_WIDTH, 0.85 * HALF_WIDTH, (count, 2))):
        instance = bpy.data.objects.new(f"Ball {index}", mesh)
        instance.location, instance.scale = (x, y, 0.2 + size), (size, size, size)
        bpy.context.scene.collection.objects.link(instance)


def ring_of_lights(count: int) -> list[AreaLight]:
    """Area lights of all shapes in a ring above the ground."""
    angles = 2.0 * math.pi * (np.arange(count) + 0.3) / count
    return [
        AreaLight(
            SHAPES[index % len(SHAPES)],
            (3.0 * math.cos(angle), 3.0 * math.sin(angle), HEIGHT),
            (0.0, 0.0, 0.3),
            WATTS / count,
            (0.9, 0.6),
        )
        for index, angle in enumerate(angles.tolist())
    ]


def add_object(name: str, mesh: bpy.types.Mesh) -> None:
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, mesh))


def add_world_light() -> None:
    """Let the world emit light too."""
    world = bpy.context.scene.world.node_tree.nodes["Background"]
    world.inputs["Color"].default_value = (0.1, 0.1, 0.1, 1.0)


def orbit_camera(angle: float) -> None:
    """Move the camera around the scene, by an angle in radians from its first position."""
    position, target, _ = CAMERA
    cosine, sine = math.cos(angle), math.sin(angle)
    camera = bpy.context.scene.camera
    camera.location = cosine * position[0] - sine * position[1], sine * position[0] + cosine * position[1], position[2]
    camera.rotation_euler = aim(tuple(camera.location), target)
