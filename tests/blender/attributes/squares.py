# SPDX-License-Identifier: GPL-3.0-or-later
"""Squares that show what the node Attribute gives, seen from above beside Cycles."""

import bpy
import numpy as np

from ism_addon.blender.sync import camera, scene_reader
from ism_addon.gpu.renderer import Profile, Renderer
from ism_addon.settings import Settings
from tests.scenes.cycles import direct_light
from tests.scenes.parts.node_tree import made

#: Pixels of a square of one unit.
SIDE = 4
OUTPUTS = "Color", "Vector", "Fac", "Alpha"
SQUARE = [(0, 0, 0), (0.98, 0, 0), (0.98, 0.98, 0), (0, 0.98, 0)], [(0, 1, 2, 3)]


def shader_of(type_, name, output, shader="ShaderNodeEmission"):
    """A material that shows an output."""

    def make(tree):
        node = tree.add("ShaderNodeAttribute", attribute_type=type_, attribute_name=name)
        return tree.add(shader, {"Color": node.outputs[output]})

    return made(make)


def see(width, height):
    """A camera above the plane from the origin on."""
    scene = bpy.context.scene
    scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(scene.camera)
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", max(width, height)
    scene.camera.location = width / 2, height / 2, 5.0
    scene.render.resolution_x, scene.render.resolution_y = SIDE * width, SIDE * height


def ours(device, samples):
    """(H,W,4), and the reader's warnings."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    scene, view, renderer = scene_reader.scene(depsgraph), camera.final_view(depsgraph), Renderer(device)
    for sample in range(samples):
        for _ in renderer.sample(scene, view, Settings(), sample, Profile()):
            pass
    picture = renderer.picture()
    renderer.release()
    return picture, scene.warnings


def centres(picture):
    """(H,W,3): the colors within squares."""
    return picture[SIDE // 2 :: SIDE, SIDE // 2 :: SIDE, :3]


def assert_as_in_cycles(device, width, height, samples=2):
    """Of squares in as many columns and rows."""
    see(width, height)
    picture, warnings = ours(device, samples)
    assert warnings == ()
    truth = centres(direct_light(1))
    assert truth.any()
    assert np.allclose(centres(picture), truth, rtol=0.02, atol=0.002)
