# SPDX-License-Identifier: GPL-3.0-or-later
"""A plane, a ball and a glossy ball that nothing shadows, in a picture of three squares; and worlds of every kind."""

import math
from collections.abc import Callable
from pathlib import Path

import bmesh
import bpy

from tests.scenes.materials.spheres import RADIUS, SUBDIVISIONS, material_of
from tests.scenes.parts.node_tree import Tree, world_of
from tests.tables.furnace import shader
from tests.tools.new_file import open_empty_file

from . import maps

#: The surfaces, from left to right.
SURFACES = "plane", "ball", "glossy ball"
DIFFUSE = shader("ShaderNodeBsdfDiffuse", {}, {"Color": (0.8, 0.8, 0.8)})
GLOSSY = shader("ShaderNodeBsdfPrincipled", {}, {"Base Color": (0.8, 0.8, 0.8), "Metallic": 1.0, "Roughness": 0.3})
#: Above the horizon, rad, from which the camera looks.
ELEVATION = math.radians(35.0)
#: Vectors to suns, as maps have them: one high, and one near the horizon.
HIGH_SUN, LOW_SUN = (-0.6, -0.5, 0.7), (0.8, -0.5, 0.15)

MakeWorld = Callable[[], bpy.types.World]


def build(side: int) -> None:
    """Open a file with the surfaces, each in a square of `side` pixels, without a world."""
    scene = open_empty_file()
    scene.world, scene.cycles.light_sampling_threshold = None, 0.0  # or faint light is left out at random
    for column, (surface, add_shader) in enumerate(zip(SURFACES, (DIFFUSE, DIFFUSE, GLOSSY), strict=True)):
        shape, mesh = bmesh.new(), bpy.data.meshes.new(surface)
        if surface == "plane":
            bmesh.ops.create_grid(shape, x_segments=1, y_segments=1, size=RADIUS)
        else:
            bmesh.ops.create_icosphere(shape, subdivisions=SUBDIVISIONS, radius=RADIUS)
        shape.to_mesh(mesh)
        shape.free()
        mesh.shade_smooth()
        mesh.materials.append(material_of(add_shader))
        thing = bpy.data.objects.new(surface, mesh)
        thing.location = column - 1.0, 0.0, 0.0
        thing.visible_shadow = thing.visible_diffuse = thing.visible_glossy = False
        scene.collection.objects.link(thing)
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", float(len(SURFACES))
    scene.camera = bpy.data.objects.new("Camera", camera)
    scene.camera.location = 0.0, -10.0 * math.cos(ELEVATION), 10.0 * math.sin(ELEVATION)
    scene.camera.rotation_euler = math.pi / 2.0 - ELEVATION, 0.0, 0.0
    scene.collection.objects.link(scene.camera)
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = len(SURFACES) * side, side, 100


def worlds() -> dict[str, MakeWorld]:
    """By name: the even world, maps of formulas, Blender's studio maps, one of them in other ways, and all skies."""
    studio = Path(bpy.utils.system_resource("DATAFILES", path="studiolights/world"))
    skies = bpy.types.ShaderNodeTexSky.bl_rna.properties["sky_type"].enum_items
    return {
        "even": lambda: world_of(lambda tree: tree.add("ShaderNodeBackground", {"Color": (1.0, 0.5, 0.25, 1.0)})),
        "map of a clear sky": lambda: maps.world_with(maps.clear(3, HIGH_SUN)),
        "the same, sun near the horizon": lambda: maps.world_with(maps.clear(3, LOW_SUN)),
        "map of an overcast sky": lambda: maps.world_with(maps.overcast(4)),
        **{f"studio map {path.stem}": lambda path=path: image_world(path) for path in sorted(studio.glob("*.exr"))},
        "studio map city, turned": lambda: image_world(studio / "city.exr", turned=True),
        "studio map city, as a mirror ball": lambda: image_world(studio / "city.exr", projection="MIRROR_BALL"),
        **{f"sky {each.name.replace(' / ', '-')}": lambda name=each.identifier: sky_world(name) for each in skies},
    }


def image_world(path: Path, turned: bool = False, projection: str = "EQUIRECTANGULAR") -> bpy.types.World:
    """A world of an image file; `turned` around all axes."""
    image = bpy.data.images.load(str(path))

    def background(tree: Tree) -> bpy.types.Node:
        texture = tree.add("ShaderNodeTexEnvironment", image=image, projection=projection)
        if turned:
            generated = tree.add("ShaderNodeTexCoord").outputs["Generated"]
            tree.link(
                tree.add("ShaderNodeMapping", {"Vector": generated, "Rotation": (0.4, 0.3, 1.0)}), texture.inputs[0]
            )
        return tree.add("ShaderNodeBackground", {"Color": texture})

    return world_of(background)


def sky_world(model: str) -> bpy.types.World:
    """A world of a Sky Texture, with the sun's disc if the model has one."""

    def background(tree: Tree) -> bpy.types.Node:
        sky = tree.add("ShaderNodeTexSky", sky_type=model)
        sky.sun_direction = HIGH_SUN
        if hasattr(sky, "sun_elevation"):
            sky.sun_elevation, sky.sun_rotation = math.radians(40.0), math.radians(130.0)
        return tree.add("ShaderNodeBackground", {"Color": sky, "Strength": 0.1})

    return world_of(background)
