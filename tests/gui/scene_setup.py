# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scenarios look at, built by script."""

import math
from collections.abc import Callable

import bmesh
import bpy
from mathutils import Euler, Vector

VIEW_ROTATION = Euler((math.radians(60.0), 0.0, math.radians(35.0)))  # looks down at the middle, from the right
BALL_SEGMENTS, BALL_RINGS = 25, 21  # 1000 triangles


def studio() -> None:
    """A cube and a ball on a floor under a square area light."""
    clear()
    add("Floor", grid(12.0))
    add("Cube", cube(1.2), (-0.9, 0.0, 0.6))
    add("Ball", ball(0.7), (1.0, 0.2, 0.7))
    area_light("Lamp", (1.5, -2.0, 4.0), watts=400.0, size=1.5)
    world(0.1)


def shadow_play() -> None:
    """A cube, a ball and a rod, black before white."""
    clear()
    black = material("Black", (0.0, 0.0, 0.0))
    for name, mesh, place in (
        ("Cube", cube(1.2), (-0.9, 0.0, 0.6)),
        ("Ball", ball(0.7), (1.0, 0.2, 0.7)),
        ("Rod", cube(0.2), (0.0, -1.5, 0.2)),
    ):
        mesh.materials.append(black)
        add(name, mesh, place)
    bpy.data.objects["Rod"].scale.x = 15.0
    scene().view_settings.view_transform = "Standard"
    world(1.0)


def crowd(balls: int = 500) -> None:
    """Balls of 1000 triangles in rows behind a free one in front, each a mesh of its own, under an area light."""
    clear()
    columns = 25
    add("Floor", grid(60.0))
    pattern = ball(0.35)
    for i in range(balls - 1):
        row, column = divmod(i, columns)
        add(f"Ball {i}", pattern.copy(), (column - 12.0, row + 2.5, 0.35))
    add("Free", pattern, (0.0, -0.5, 0.35))
    pattern.materials.append(material("Red", (0.9, 0.05, 0.05)))
    area_light("Lamp", (2.0, -4.0, 8.0), watts=2500.0, size=3.0)
    world(0.1)


def clear() -> None:
    """Remove all objects."""
    bpy.data.batch_remove([*bpy.data.objects, *bpy.data.meshes, *bpy.data.lights])


def add(name: str, data: bpy.types.ID, place: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> bpy.types.Object:
    """A new object in the scene."""
    thing = bpy.data.objects.new(name, data)
    thing.location = place
    scene().collection.objects.link(thing)
    return thing


def collection(name: str, *things: bpy.types.Object) -> bpy.types.Collection:
    """A new collection, not in the scene, of objects that are."""
    made = bpy.data.collections.new(name)
    for thing in things:
        scene().collection.objects.unlink(thing)
        made.objects.link(thing)
    return made


def area_light(name: str, place: tuple[float, float, float], watts: float, size: float) -> bpy.types.Object:
    """A square area light that looks at the middle."""
    light = bpy.data.lights.new(name, "AREA")
    light.energy, light.size = watts, size
    thing = add(name, light, place)
    thing.rotation_euler = Vector(place).to_track_quat("Z", "Y").to_euler()
    return thing


def world(strength: float) -> None:
    """A grey sky."""
    scene().world.use_nodes = True
    background = scene().world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (strength, strength, strength, 1.0)


def material(name: str, color: tuple[float, float, float]) -> bpy.types.Material:
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    recolour(made.name, color)
    return made


def recolour(name: str, color: tuple[float, float, float]) -> None:
    """Give a material another base colour."""
    shader = bpy.data.materials[name].node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1.0)


def stretch(mesh: bpy.types.Mesh) -> None:
    """Make a mesh higher."""
    for vertex in mesh.vertices:
        vertex.co.z *= 2.0
    mesh.update()


def set_view(view: bpy.types.RegionView3D, distance: float = 7.0) -> None:
    """Point a viewport at the middle."""
    view.view_perspective = "PERSP"
    view.view_location = (0.0, 0.0, 0.5)
    view.view_rotation = VIEW_ROTATION.to_quaternion()
    view.view_distance = distance


def camera(distance: float = 9.0) -> bpy.types.Object:
    """The scene's camera, looking at the middle."""
    thing = add("Camera", bpy.data.cameras.new("Camera"))
    thing.rotation_euler = VIEW_ROTATION
    thing.location = Vector((0.0, 0.0, 0.5)) + VIEW_ROTATION.to_quaternion() @ Vector((0.0, 0.0, distance))
    scene().camera = thing
    return thing


def scene() -> bpy.types.Scene:
    return bpy.context.window_manager.windows[0].scene


def grid(width: float) -> bpy.types.Mesh:
    """A floor."""
    return _mesh("Grid", lambda made: bmesh.ops.create_grid(made, x_segments=8, y_segments=8, size=0.5 * width))


def cube(width: float) -> bpy.types.Mesh:
    return _mesh("Cube", lambda made: bmesh.ops.create_cube(made, size=width))


def ball(radius: float) -> bpy.types.Mesh:
    """A thousand triangles."""
    return _mesh(
        "Ball",
        lambda made: bmesh.ops.create_uvsphere(made, u_segments=BALL_SEGMENTS, v_segments=BALL_RINGS, radius=radius),
    )


def triangles() -> int:
    """How many the scene's meshes have."""
    meshes = [thing.data for thing in scene().objects if thing.type == "MESH"]
    return sum(len(mesh.loops) - 2 * len(mesh.polygons) for mesh in meshes)


def _mesh(name: str, fill: Callable) -> bpy.types.Mesh:
    made, mesh = bmesh.new(), bpy.data.meshes.new(name)
    fill(made)
    made.to_mesh(mesh)
    made.free()
    return mesh
