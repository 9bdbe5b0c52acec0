# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds and changes the scenes of the scenarios."""

import math
from collections.abc import Callable

import bmesh
import bpy
from mathutils import Euler, Vector

VIEW_ROTATION = Euler(
    (math.radians(60.0), 0.0, math.radians(35.0))
)  # looks down at the middle of the scene, from the right
BALL_SEGMENTS, BALL_RINGS = 25, 21  # 1000 triangles


def build_studio() -> None:
    """A cube and a ball on a floor under a square area light."""
    clear()
    add_object("Floor", grid(12.0))
    add_object("Cube", cube(1.2), (-0.9, 0.0, 0.6))
    add_object("Ball", ball(0.7), (1.0, 0.2, 0.7))
    add_area_light("Lamp", (1.5, -2.0, 4.0), watts=400.0, size=1.5)
    set_world(0.1)


def build_silhouettes() -> None:
    """A cube, a ball and a rod, black before a white world."""
    clear()
    black = new_material("Black", (0.0, 0.0, 0.0))
    for name, mesh, location in (
        ("Cube", cube(1.2), (-0.9, 0.0, 0.6)),
        ("Ball", ball(0.7), (1.0, 0.2, 0.7)),
        ("Rod", cube(0.2), (0.0, -1.5, 0.2)),
    ):
        mesh.materials.append(black)
        add_object(name, mesh, location)
    bpy.data.objects["Rod"].scale.x = 15.0
    scene().view_settings.view_transform = "Standard"
    set_world(1.0)


def build_many_balls(balls: int = 500) -> None:
    """Rows of balls under an area light, and one in front of them, "Free". Each has 1000 triangles and its own mesh."""
    clear()
    columns = 25
    add_object("Floor", grid(60.0))
    mesh = ball(0.35)
    for i in range(balls - 1):
        row, column = divmod(i, columns)
        add_object(f"Ball {i}", mesh.copy(), (column - 12.0, row + 2.5, 0.35))
    add_object("Free", mesh, (0.0, -0.5, 0.35))
    mesh.materials.append(new_material("Red", (0.9, 0.05, 0.05)))
    add_area_light("Lamp", (2.0, -4.0, 8.0), watts=2500.0, size=3.0)
    set_world(0.1)


def clear() -> None:
    """Remove all objects."""
    bpy.data.batch_remove([*bpy.data.objects, *bpy.data.meshes, *bpy.data.lights])


def add_object(
    name: str, data: bpy.types.ID, location: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> bpy.types.Object:
    """Add an object to the scene."""
    obj = bpy.data.objects.new(name, data)
    obj.location = location
    scene().collection.objects.link(obj)
    return obj


def move_to_collection(name: str, *objects: bpy.types.Object) -> bpy.types.Collection:
    """Move objects out of the scene into a new collection that is not in the scene."""
    group = bpy.data.collections.new(name)
    for obj in objects:
        scene().collection.objects.unlink(obj)
        group.objects.link(obj)
    return group


def add_area_light(name: str, location: tuple[float, float, float], watts: float, size: float) -> bpy.types.Object:
    """Add a square area light that faces the middle of the scene."""
    light = bpy.data.lights.new(name, "AREA")
    light.energy, light.size = watts, size
    obj = add_object(name, light, location)
    obj.rotation_euler = Vector(location).to_track_quat("Z", "Y").to_euler()
    return obj


def set_world(strength: float, shadows: bool = False) -> None:
    """Light the scene by a grey world. Its shadows take most of a picture's time."""
    scene().ism.shadow.world = shadows
    scene().world.use_nodes = True
    background = scene().world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (strength, strength, strength, 1.0)


def new_material(name: str, color: tuple[float, float, float]) -> bpy.types.Material:
    """A material without gloss."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes["Principled BSDF"].inputs["Specular IOR Level"].default_value = 0.0
    recolor(material.name, color)
    return material


def recolor(name: str, color: tuple[float, float, float]) -> None:
    """Give a material another base colour."""
    shader = bpy.data.materials[name].node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1.0)


def stretch(mesh: bpy.types.Mesh) -> None:
    """Double a mesh's height."""
    for vertex in mesh.vertices:
        vertex.co.z *= 2.0
    mesh.update()


def set_view(view: bpy.types.RegionView3D, distance: float = 7.0) -> None:
    """Point a viewport at the middle of the scene."""
    view.view_perspective = "PERSP"
    view.view_location = (0.0, 0.0, 0.5)
    view.view_rotation = VIEW_ROTATION.to_quaternion()
    view.view_distance = distance


def add_camera(distance: float = 9.0) -> bpy.types.Object:
    """Add the scene's camera, which looks at the middle of the scene."""
    obj = add_object("Camera", bpy.data.cameras.new("Camera"))
    obj.rotation_euler = VIEW_ROTATION
    obj.location = Vector((0.0, 0.0, 0.5)) + VIEW_ROTATION.to_quaternion() @ Vector((0.0, 0.0, distance))
    scene().camera = obj
    return obj


def scene() -> bpy.types.Scene:
    return bpy.context.window_manager.windows[0].scene


def grid(width: float) -> bpy.types.Mesh:
    """A square of 8×8 faces."""
    return _mesh("Grid", lambda bm: bmesh.ops.create_grid(bm, x_segments=8, y_segments=8, size=0.5 * width))


def cube(width: float) -> bpy.types.Mesh:
    return _mesh("Cube", lambda bm: bmesh.ops.create_cube(bm, size=width))


def ball(radius: float) -> bpy.types.Mesh:
    """A UV sphere of 1000 triangles."""
    return _mesh(
        "Ball",
        lambda bm: bmesh.ops.create_uvsphere(bm, u_segments=BALL_SEGMENTS, v_segments=BALL_RINGS, radius=radius),
    )


def triangle_count() -> int:
    """The number of triangles in the scene's meshes."""
    meshes = [obj.data for obj in scene().objects if obj.type == "MESH"]
    return sum(len(mesh.loops) - 2 * len(mesh.polygons) for mesh in meshes)


def _mesh(name: str, fill: Callable) -> bpy.types.Mesh:
    bm, mesh = bmesh.new(), bpy.data.meshes.new(name)
    fill(bm)
    bm.to_mesh(mesh)
    bm.free()
    return mesh
