# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts a scene and its view to Blender objects, which store float32, and reads them back as the engine does."""

import math

import bpy
import numpy as np
from mathutils import Matrix

from ism_addon import addon
from ism_addon.blender.sync import camera, scene_reader
from ism_addon.scene import Lights, LightShape, Scene, View
from tests.scenes.parts.diffuse import make_diffuse
from tests.tools.new_file import open_empty_file


def into_blender(scene: Scene, view: View) -> None:
    """Build the scene in a new file. A mesh is shaded smooth if any triangle's normals differ."""
    open_empty_file()
    meshes = []
    for source in scene.meshes:
        mesh = bpy.data.meshes.new("Mesh")
        points, corners = np.unique(source.positions, axis=0, return_inverse=True)
        mesh.from_pydata(points.tolist(), [], corners.reshape(-1)[source.triangles].tolist())
        mesh.shade_smooth() if np.ptp(source.corner_normals, axis=1).max() > 1e-3 else mesh.shade_flat()
        mesh.materials.append(material(scene, source.materials[0]))
        meshes.append(mesh)
    instances = scene.instances.mesh, scene.instances.world_from_object, scene.instances.visible
    for mesh_id, matrix, visible in zip(*instances, strict=True):
        add_object("Thing", meshes[mesh_id], matrix).visible_camera = bool(visible)
    for index in range(len(scene.lights.shape)):
        add_light(scene, index)
    add_camera(view)
    bpy.context.scene.cycles.light_sampling_threshold = 0.0  # else Cycles samples faint lights stochastically
    bpy.context.scene.world = world = bpy.data.worlds.new("World")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*map(float, scene.world.radiance), 1.0)


def material(scene: Scene, row: int) -> bpy.types.Material:
    """A diffuse material, which may emit."""
    name = f"Material {row}"
    if name in bpy.data.materials:
        return bpy.data.materials[name]
    made, emission = bpy.data.materials.new(name), scene.materials.emission[row]
    strength = float(emission.max())
    base_color = map(float, scene.materials.base_color[row])
    make_diffuse(made, tuple(base_color), tuple(map(float, emission / (strength or 1.0))), strength)
    return made


def out_of_blender() -> tuple[Scene, View]:
    """The scene and view of the open file, as a final render reads them."""
    addon.register()
    try:
        depsgraph = bpy.context.evaluated_depsgraph_get()
        return scene_reader.scene(depsgraph), camera.final_view(depsgraph)
    finally:
        addon.unregister()


def add_object(name: str, data: bpy.types.ID, matrix: np.ndarray) -> bpy.types.Object:
    """Link a new object whose world matrix is `matrix`, by way of a parent."""
    instance = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(instance)
    instance.parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(instance.parent)
    instance.matrix_parent_inverse = Matrix(matrix)  # location, rotation and scale could not hold shears
    return instance


def add_light(scene: Scene, row: int) -> None:
    lights, shape = scene.lights, LightShape(scene.lights.shape[row])
    if shape in (LightShape.POINT, LightShape.SPOT, LightShape.SUN):
        add_small_light(lights, row, shape)
        return
    width, height = np.linalg.norm(lights.axis_u[row]), np.linalg.norm(lights.axis_v[row])
    light = bpy.data.lights.new("Light", "AREA")
    is_ellipse = lights.shape[row] == LightShape.ELLIPSE
    light.shape, light.size, light.size_y = "ELLIPSE" if is_ellipse else "RECTANGLE", width, height
    light.spread, light.use_shadow = float(lights.spread[row]), bool(lights.casts_shadow[row])
    max_radiance = float(lights.emission[row].max())
    light.color = lights.emission[row] / max_radiance
    light.energy = math.pi * width * height * (math.pi / 4.0 if is_ellipse else 1.0) * max_radiance
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 2], matrix[:3, 3] = lights.axis_u[row] / width, -lights.normal[row], lights.position[row]
    matrix[:3, 1] = np.cross(matrix[:3, 2], matrix[:3, 0])
    add_object("Light", light, matrix)


def add_small_light(lights: Lights, row: int, shape: LightShape) -> None:
    """A point, a spot or a sun."""
    light = bpy.data.lights.new("Light", shape.name)
    strength = float(lights.emission[row].max())
    light.color, light.use_shadow = lights.emission[row] / strength, bool(lights.casts_shadow[row])
    if shape is LightShape.SUN:
        light.energy, light.angle = strength, float(lights.spread[row])
    else:
        light.energy, light.shadow_soft_size = 4.0 * math.pi * strength, float(lights.radius[row])
        light.use_soft_falloff = bool(lights.soft_falloff[row])
    if shape is LightShape.SPOT:
        light.spot_size, light.spot_blend = float(lights.spread[row]), float(lights.blend[row])
    matrix = np.eye(4)
    columns = lights.axis_u[row], -lights.axis_v[row], -lights.normal[row], lights.position[row]
    matrix[:3] = np.stack(columns, 1)
    add_object("Light", light, matrix)


def add_camera(view: View) -> None:
    camera_data = bpy.data.cameras.new("Camera")
    clip = view.clip_from_view
    if clip[3, 2]:
        camera_data.angle = 2.0 * math.atan(1.0 / clip[0, 0])
        camera_data.clip_start, camera_data.clip_end = clip[2, 3] / (clip[2, 2] - 1.0), clip[2, 3] / (clip[2, 2] + 1.0)
    else:
        camera_data.type, camera_data.ortho_scale = "ORTHO", 2.0 / clip[0, 0]
    scene = bpy.context.scene
    scene.camera = add_object("Camera", camera_data, np.linalg.inv(view.view_from_world))
    camera_data.sensor_fit = "HORIZONTAL"
    scene.render.resolution_x, scene.render.resolution_y = view.width, view.height
    scene.render.resolution_percentage = 100
