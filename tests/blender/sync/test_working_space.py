# SPDX-License-Identifier: GPL-3.0-or-later
"""The working colour space of a file: images of all types, lights and the world, compared with Cycles."""

import math

import bpy
import numpy as np
import pytest

from ism_addon.blender.sync.materials import images
from ism_addon.color import PRIMARIES
from ism_addon.gpu.buffers.mip_levels import decoded
from tests.scenes.cycles import direct_light
from tests.tools.new_file import open_empty_file

#: Blender has only one before 5.0.
SPACES = list(PRIMARIES) if bpy.app.version >= (5, 0) else ["Linear Rec.709"]
IMAGES = {"sRGB": {}, "Linear Rec.709": {}, "Non-Color": {"is_data": True}, "float": {"float_buffer": True}}


@pytest.fixture(params=SPACES)
def space(request, empty_scene):
    if bpy.app.version >= (5, 0):
        bpy.ops.wm.set_working_color_space(working_space=request.param, convert_colors=False)
    assert images.working_space() == request.param
    yield request.param
    open_empty_file()


def test_all_working_spaces_of_blender_are_known():
    if bpy.app.version >= (5, 0):
        names = bpy.data.colorspace.bl_rna.properties["working_space"].enum_items.keys()
        assert set(names) == set(PRIMARIES)


def cycles_color(scene, add):
    """(3,) the colour at (0.5, 0.5, 0), as Cycles renders it for a camera above that."""
    scene.camera = add("Camera", bpy.data.cameras.new("Camera"))
    scene.camera.location = 0.5, 0.5, 1.0
    scene.render.resolution_x = scene.render.resolution_y = 4
    return direct_light(4)[2, 2, :3]


@pytest.mark.parametrize("image_type", IMAGES)
def test_texels_equal_those_of_cycles(add, read_scene, empty_scene, space, image_type):
    image = bpy.data.images.new("Picture", 2, 2, **IMAGES[image_type])
    if image_type == "Linear Rec.709":
        image.colorspace_settings.name = image_type
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
    scene = read_scene()
    assert scene.warnings == () and scene.working_space == space
    tree.links.new(node.outputs["Color"], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    ours = decoded(scene.images[0].texels, scene.images[0])[0, 0, :3]
    assert np.allclose(ours, cycles_color(empty_scene, add), atol=0.004)


def test_the_world_and_a_lights_temperature_equal_those_of_cycles(add, read_scene, empty_scene, space):
    light = bpy.data.lights.new("Lamp", "AREA")
    light.color, light.energy, light.size = (1, 0.5, 0.25), 3.0, 2.0
    if hasattr(light, "use_temperature"):
        light.use_temperature, light.temperature = True, 3000.0
    light_object = add("Lamp", light)
    light_object.location, light_object.rotation_euler = (0.5, 0.5, 0.0), (math.pi, 0, 0)
    light_object.visible_camera = True
    assert np.allclose(read_scene().lights.emission[0], cycles_color(empty_scene, add), rtol=1e-3)
    world = empty_scene.world = bpy.data.worlds.new("World")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.25, 0.125, 1)
    light_object.hide_render = True
    assert np.allclose(read_scene().world.radiance, cycles_color(empty_scene, add), rtol=1e-5)
