# SPDX-License-Identifier: GPL-3.0-or-later
"""The working space of a file's colours, beside Cycles: images of all kinds, lights and the world."""

import math

import bpy
import numpy as np
import pytest

from ism_addon.blender.sync.materials import images
from ism_addon.color import PRIMARIES
from ism_addon.gpu.buffers.material_buffers import decoded
from tests.scenes.cycles import direct_light
from tests.tools.new_file import open_empty_file

#: Before Blender 5.0 there is one only.
SPACES = list(PRIMARIES) if bpy.app.version >= (5, 0) else ["Linear Rec.709"]
IMAGES = {"sRGB": {}, "Linear Rec.709": {}, "Non-Color": {"is_data": True}, "float": {"float_buffer": True}}


@pytest.fixture(params=SPACES)
def space(request, empty_scene):
    if bpy.app.version >= (5, 0):
        bpy.ops.wm.set_working_color_space(working_space=request.param, convert_colors=False)
    assert images.working_space() == request.param
    yield request.param
    open_empty_file()


def test_all_spaces_of_blender_are_known():
    if bpy.app.version >= (5, 0):
        names = bpy.data.colorspace.bl_rna.properties["working_space"].enum_items.keys()
        assert set(names) == set(PRIMARIES)


def seen(scene, add):
    """(3,) what Cycles shows of a square under a camera."""
    scene.camera = add("Camera", bpy.data.cameras.new("Camera"))
    scene.camera.location = 0.5, 0.5, 1.0
    scene.render.resolution_x = scene.render.resolution_y = 4
    return direct_light(4)[2, 2, :3]


@pytest.mark.parametrize("kind", IMAGES)
def test_texels_are_what_cycles_shows(add, extracted, empty_scene, space, kind):
    image = bpy.data.images.new("Picture", 2, 2, **IMAGES[kind])
    if kind == "Linear Rec.709":
        image.colorspace_settings.name = kind
    image.pixels.foreach_set(np.float32([0.6, 0.2, 0.1, 1.0] * 4))
    thing = add("Square")
    thing.data.uv_layers.new()
    material = bpy.data.materials.new("Paint")
    material.use_nodes = True
    tree = material.node_tree
    node, emission = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeEmission")
    node.image = image
    thing.data.materials.append(material)
    tree.links.new(node.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    scene = extracted()
    assert scene.warnings == () and scene.working_space == space
    tree.links.new(node.outputs["Color"], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    ours = decoded(scene.images[0])[0, 0, :3]
    assert np.allclose(ours, seen(empty_scene, add), atol=0.004)


def test_the_world_and_a_lights_temperature_are_what_cycles_shows(add, extracted, empty_scene, space):
    light = bpy.data.lights.new("Lamp", "AREA")
    light.color, light.energy, light.size = (1, 0.5, 0.25), 3.0, 2.0
    if hasattr(light, "use_temperature"):
        light.use_temperature, light.temperature = True, 3000.0
    lamp = add("Lamp", light)
    lamp.location, lamp.rotation_euler, lamp.visible_camera = (0.5, 0.5, 0.0), (math.pi, 0, 0), True
    assert np.allclose(extracted().lights.radiance[0], seen(empty_scene, add), rtol=1e-3)
    world = empty_scene.world = bpy.data.worlds.new("World")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.25, 0.125, 1)
    lamp.hide_render = True
    assert np.allclose(extracted().world.radiance, seen(empty_scene, add), rtol=1e-5)
