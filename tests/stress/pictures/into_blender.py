# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene and its view as objects in Blender, which hold them in float32; and back, as our engine reads them."""

import math

import bpy
import numpy as np
from mathutils import Matrix

from ism_addon import addon
from ism_addon.blender.sync import camera, scene_reader
from ism_addon.scene import LightShape, Scene, View
from tests.tools.new_file import open_empty_file


def into_blender(scene: Scene, view: View) -> None:
    """In a new file; grey surfaces, smooth where the normals of a triangle's corners differ."""
    open_empty_file()
    material = bpy.data.materials.new("Grey")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    diffuse, output = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
    diffuse.inputs["Color"].default_value = (*map(float, scene.materials.base_color[0]), 1.0)
    material.node_tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    meshes = []
    for source in scene.meshes:
        made = bpy.data.meshes.new("Mesh")
        points, corners = np.unique(source.positions, axis=0, return_inverse=True)
        made.from_pydata(points.tolist(), [], corners.reshape(-1)[source.triangles].tolist())
        made.shade_smooth() if np.ptp(source.corner_normals, axis=1).max() > 1e-3 else made.shade_flat()
        made.materials.append(material)
        meshes.append(made)
    rows = scene.instances.mesh, scene.instances.world_from_object, scene.instances.visible
    for mesh, matrix, visible in zip(*rows, strict=True):
        place("Thing", meshes[mesh], matrix).visible_camera = bool(visible)
    for row in range(len(scene.lights.shape)):
        add_light(scene, row)
    add_camera(view)
    bpy.context.scene.cycles.light_sampling_threshold = 0.0  # else it leaves faint light to chance
    bpy.context.scene.world = bpy.data.worlds.new("Black")
    bpy.context.scene.world.use_nodes = False
    bpy.context.scene.world.color = (0.0, 0.0, 0.0)


def out_of_blender() -> tuple[Scene, View]:
    """The open file, as a final render has it."""
    addon.register()
    try:
        depsgraph = bpy.context.evaluated_depsgraph_get()
        return scene_reader.scene(depsgraph), camera.final_view(depsgraph)
    finally:
        addon.unregister()


def place(name: str, data: bpy.types.ID, matrix: np.ndarray) -> bpy.types.Object:
    thing = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(thing)
    thing.parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(thing.parent)
    thing.matrix_parent_inverse = Matrix(matrix)  # location, rotation and scale could not hold shears
    return thing


def add_light(scene: Scene, row: int) -> None:
    lights = scene.lights
    width, height = np.linalg.norm(lights.axis_u[row]), np.linalg.norm(lights.axis_v[row])
    made = bpy.data.lights.new("Light", "AREA")
    ellipse = lights.shape[row] == LightShape.ELLIPSE
    made.shape, made.size, made.size_y = "ELLIPSE" if ellipse else "RECTANGLE", width, height
    made.spread, made.use_shadow = float(lights.spread[row]), bool(lights.casts_shadow[row])
    brightest = float(lights.radiance[row].max())
    made.color = lights.radiance[row] / brightest
    made.energy = math.pi * width * height * (math.pi / 4.0 if ellipse else 1.0) * brightest
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 2], matrix[:3, 3] = lights.axis_u[row] / width, -lights.normal[row], lights.position[row]
    matrix[:3, 1] = np.cross(matrix[:3, 2], matrix[:3, 0])
    place("Light", made, matrix)


def add_camera(view: View) -> None:
    lens = bpy.data.cameras.new("Camera")
    clip = view.clip_from_view
    if clip[3, 2]:
        lens.angle = 2.0 * math.atan(1.0 / clip[0, 0])
        lens.clip_start, lens.clip_end = clip[2, 3] / (clip[2, 2] - 1.0), clip[2, 3] / (clip[2, 2] + 1.0)
    else:
        lens.type, lens.ortho_scale = "ORTHO", 2.0 / clip[0, 0]
    scene = bpy.context.scene
    scene.camera = place("Camera", lens, np.linalg.inv(view.view_from_world))
    lens.sensor_fit = "HORIZONTAL"
    scene.render.resolution_x, scene.render.resolution_y = view.width, view.height
    scene.render.resolution_percentage = 100
