# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of rows of spheres, each with a shader of its own, under one light."""

import math
from collections.abc import Callable, Sequence

import bmesh
import bpy
import numpy as np
from mathutils import Vector

from tests.tables.furnace import Shader
from tests.tools.new_file import open_empty_file

#: Radius of the spheres, whose middles are 1 m apart. They have 20 × 4⁵ triangles.
RADIUS, SUBDIVISIONS = 0.46, 6
#: From the middle of the spheres to the light, as a multiple of the picture's larger side.
TO_LIGHT = Vector((-0.35, 0.45, 0.8))


def build(shaders: Sequence[Shader], columns: int, side: int) -> None:
    """Open a file with a sphere for each shader, in rows from the bottom left, without a light.

    `side` is the number of pixels along the sides of a sphere's square.
    """
    scene, rows = open_empty_file(), math.ceil(len(shaders) / columns)
    scene.world, scene.cycles.light_sampling_threshold = None, 0.0  # or faint light is left out at random
    shape, mesh = bmesh.new(), bpy.data.meshes.new("Sphere")
    bmesh.ops.create_icosphere(shape, subdivisions=SUBDIVISIONS, radius=RADIUS)
    shape.to_mesh(mesh)
    shape.free()
    mesh.shade_smooth()
    mesh.materials.append(None)
    for index, add_shader in enumerate(shaders):
        row, column = divmod(index, columns)
        sphere = bpy.data.objects.new("Sphere", mesh)
        sphere.material_slots[0].link = "OBJECT"
        sphere.material_slots[0].material = material_of(add_shader)
        sphere.location = column - 0.5 * (columns - 1), row - 0.5 * (rows - 1), 0.0
        sphere.rotation_euler = 0.5, 0.3, 0.2  # tangents around its z axis are not those around the camera's
        scene.collection.objects.link(sphere)
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", max(columns, rows)
    scene.camera = bpy.data.objects.new("Camera", camera)
    scene.camera.location = 0.0, 0.0, 2.0
    scene.collection.objects.link(scene.camera)
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = columns * side, rows * side, 100


def squares(picture: np.ndarray, side: int) -> np.ndarray:
    """The square (side,side,3) of each sphere in a picture (H,W,3): (N,side,side,3), rows from the bottom left."""
    rows, columns = picture.shape[0] // side, picture.shape[1] // side
    return picture.reshape(rows, side, columns, side, 3).swapaxes(1, 2).reshape(-1, side, side, 3)


def material_of(add_shader: Shader) -> bpy.types.Material:
    """A material with one shader."""
    material = bpy.data.materials.new("Material")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(add_shader(tree), output.inputs["Surface"])
    return material


def add_lamp(type_: str, energy: float, **properties: object) -> None:
    """Add a lamp that shines at the spheres; of a sun, the energy is W/m², of others that at a distance of 1 m."""
    light, distance = bpy.data.lights.new("Lamp", type_), bpy.context.scene.camera.data.ortho_scale
    for name, value in properties.items():
        setattr(light, name, value * distance if name in ("size", "size_y", "shadow_soft_size") else value)
    light.energy = energy if type_ == "SUN" else energy * distance**2
    lamp = bpy.data.objects.new("Lamp", light)
    aim(lamp, distance)


def aim(thing: bpy.types.Object, distance: float) -> None:
    """Place what shines along its -z at the spheres."""
    thing.location = distance * TO_LIGHT
    thing.rotation_euler = TO_LIGHT.to_track_quat("Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(thing)


def add_emitter(energy: float) -> None:
    """Add a mesh that shines at the spheres."""
    distance = bpy.context.scene.camera.data.ortho_scale
    shape, mesh = bmesh.new(), bpy.data.meshes.new("Emitter")
    bmesh.ops.create_cube(shape, size=0.5 * distance)
    shape.to_mesh(mesh)
    shape.free()
    mesh.materials.append(material_of(lambda tree: emission(tree, energy)))
    aim(bpy.data.objects.new("Emitter", mesh), distance)


def emission(tree: bpy.types.NodeTree, strength: float) -> bpy.types.NodeSocket:
    """A shader that emits."""
    node = tree.nodes.new("ShaderNodeEmission")
    node.inputs["Strength"].default_value = strength
    return node.outputs[0]


def add_world() -> None:
    """Light from all directions."""
    world = bpy.context.scene.world = bpy.data.worlds.new("World")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)


#: By name, functions that add a light. They are so large that several pixels of a mirror show them.
LIGHTS: dict[str, Callable[[], None]] = {
    "point": lambda: add_lamp("POINT", 40.0, shadow_soft_size=0.3),
    "spot": lambda: add_lamp("SPOT", 40.0, shadow_soft_size=0.3, spot_size=1.6, spot_blend=0.5),
    "sun": lambda: add_lamp("SUN", 3.0, angle=0.6),
    "rectangle": lambda: add_lamp("AREA", 10.0, shape="RECTANGLE", size=1.2, size_y=0.6),
    "ellipse": lambda: add_lamp("AREA", 10.0, shape="ELLIPSE", size=0.6, size_y=1.2),
    "mesh": lambda: add_emitter(6.0),
    "world": add_world,
}
