# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures by Cycles of flat squares, each with a material of its own, all seen from the same direction."""

import math
from collections.abc import Callable, Sequence

import bpy
import numpy as np

from tests.scenes.cycles import direct_light
from tests.tools.new_file import open_empty_file

#: Adds nodes to a material: the socket of its shader.
Shader = Callable[[bpy.types.NodeTree], bpy.types.NodeSocket]
#: Pixels along the sides of a square, and those at its border left out.
SIDE, BORDER = 8, 2
#: W/m² of suns: Cycles leaves out faint light at random.
IRRADIANCE = 1e8


def shader(name: str, options: dict[str, object], inputs: dict[str, object]) -> Shader:
    """A node with properties and inputs by their names. Arrays of three are colours."""

    def add(tree: bpy.types.NodeTree) -> bpy.types.NodeSocket:
        node = tree.nodes.new(name)
        for key, value in options.items():
            setattr(node, key, value)
        for key, value in inputs.items():
            node.inputs[key].default_value = (*value, 1.0) if np.ndim(value) else value
        return node.outputs[0]

    return add


def build(shaders: Sequence[Shader], cosine: float) -> None:
    """A new file with a square for each shader, in the plane z = 0, and a camera in the plane of x and z."""
    open_empty_file()
    scene = bpy.context.scene
    columns = math.ceil(math.sqrt(len(shaders)))
    rows = math.ceil(len(shaders) / columns)
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    for k, add_shader in enumerate(shaders):
        row, column = divmod(k, columns)
        # The camera's up is -x: its rows of pixels are foreshortened. No pixel's centre is on a square's diagonal, as
        # rays may pass between two triangles.
        at = corners + [row - 0.5 * rows, column - 0.5 * columns + 0.3 / SIDE]
        mesh = bpy.data.meshes.new("square")
        mesh.from_pydata([(-x / cosine, y, 0.0) for x, y in at], [], [(0, 1, 2, 3)])
        material = bpy.data.materials.new("material")
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        tree.links.new(add_shader(tree), output.inputs["Surface"])
        mesh.materials.append(material)
        scene.collection.objects.link(bpy.data.objects.new("square", mesh))
    camera = bpy.data.cameras.new("camera")
    distance = max(columns, rows) / cosine
    camera.type, camera.ortho_scale, camera.clip_end = "ORTHO", max(columns, rows), 2.0 * distance
    scene.camera = bpy.data.objects.new("camera", camera)
    angle = math.acos(cosine)
    scene.camera.location = distance * math.sin(angle), 0.0, distance * cosine
    scene.camera.rotation_euler = angle, 0.0, 0.5 * math.pi
    scene.collection.objects.link(scene.camera)
    scene.render.resolution_x, scene.render.resolution_y = columns * SIDE, rows * SIDE
    scene.render.resolution_percentage = 100


def means(count: int, samples: int) -> np.ndarray:
    """(count,3) mean radiance of the squares."""
    render = bpy.context.scene.render
    rows, columns = render.resolution_y // SIDE, render.resolution_x // SIDE
    pixels = direct_light(samples)[..., :3].astype(np.float64)
    squares = pixels.reshape(rows, SIDE, columns, SIDE, 3)[:, BORDER:-BORDER, :, BORDER:-BORDER]
    return squares.mean((1, 3)).reshape(-1, 3)[:count]


def white_furnace(shaders: Sequence[Shader], cosine: float, samples: int) -> np.ndarray:
    """(N,3) radiance that shaders reflect of an environment of radiance 1."""
    build(shaders, cosine)
    world = bpy.context.scene.world = bpy.data.worlds.new("white")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    return means(len(shaders), samples)


def under_suns(shaders: Sequence[Shader], cosine: float, directions: np.ndarray) -> np.ndarray:
    """(D,N,3) radiance by parallel light of irradiance 1 from directions (D,3): BRDFs times the light's cosine.

    x is the direction to the camera, projected onto the squares.
    """
    build(shaders, cosine)
    light = bpy.data.lights.new("sun", "SUN")
    light.angle, light.energy = 0.0, IRRADIANCE
    sun = bpy.data.objects.new("sun", light)
    bpy.context.scene.collection.objects.link(sun)
    radiance = []
    for x, y, z in directions:
        sun.rotation_euler = 0.0, math.acos(z), math.atan2(y, x)
        radiance.append(means(len(shaders), 1) / IRRADIANCE)
    return np.array(radiance)
