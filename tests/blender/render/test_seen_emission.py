# SPDX-License-Identifier: GPL-3.0-or-later
"""Emission that varies over a surface, as the camera sees it, beside Cycles."""

import bpy
import numpy as np
import pytest

from tests.scenes.cycles import direct_light
from tests.scenes.parts.node_tree import made

from .test_transparency import SIDE, ours

FILTER_WIDTH = 1.5


def stripes(tree):
    """An image of eight stripes."""
    texels = np.ones((16, 16, 4), np.float32)
    texels[..., 0], texels[..., 1] = np.arange(16) // 2 % 2, np.linspace(0.0, 1.0, 16)[:, None]
    image = bpy.data.images.new("stripes", 16, 16)
    image.pixels.foreach_set(texels.ravel())
    image.pack()
    return tree.add("ShaderNodeTexImage", image=image)


def emission(tree, color=(1.0, 1.0, 1.0, 1.0), strength=2.0):
    return tree.add("ShaderNodeEmission", {"Color": color, "Strength": strength})


def principled(tree):
    """An image as emission, and its red as alpha."""
    image = stripes(tree)
    red = tree.add("ShaderNodeSeparateColor", {"Color": image}).outputs["Red"]
    black = (0.0, 0.0, 0.0, 1.0)
    inputs = {"Base Color": black, "Emission Color": image, "Emission Strength": 2.0, "Alpha": red}
    return tree.add("ShaderNodeBsdfPrincipled", inputs | {"Specular IOR Level": 0.0})


def rim(tree):
    """Brighter at grazing angles."""
    return emission(tree, strength=tree.add("ShaderNodeLayerWeight").outputs["Facing"])


SURFACES = {
    "image": lambda tree: emission(tree, stripes(tree)),
    "noise": lambda tree: emission(tree, tree.add("ShaderNodeTexNoise", {"Scale": 3.0}).outputs["Color"]),
    "rim": rim,
    "principled": principled,
}


@pytest.mark.parametrize("name", SURFACES)
def test_surfaces_emit_what_their_nodes_give(device, empty_scene, name):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, size=2.0)
    pane = bpy.context.object
    for vertex in pane.data.vertices:  # curved, so that its normals differ
        vertex.co.z = -0.3 * (vertex.co.x**2 + vertex.co.y**2)
    pane.data.shade_smooth()
    pane.data.materials.append(made(SURFACES[name]))
    empty_scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    empty_scene.collection.objects.link(empty_scene.camera)
    empty_scene.camera.location, empty_scene.camera.rotation_euler = (0.0, -2.2, 2.2), (0.785, 0.0, 0.0)
    empty_scene.render.resolution_x = empty_scene.render.resolution_y = SIDE
    empty_scene.render.filter_size = FILTER_WIDTH
    picture, warnings = ours(device)
    picture = picture[..., :3]
    assert warnings == ()
    truth = direct_light(256, FILTER_WIDTH)[..., :3]
    noise = 0.08 if name == "principled" else 0.03  # of surfaces that are half transparent at edges of the image
    assert np.sqrt(np.mean((picture - truth) ** 2)) < noise * truth.mean()
    assert abs(picture.mean() / truth.mean() - 1.0) < 0.005
