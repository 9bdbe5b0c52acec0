# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes of objects, instancers and view layers beside Cycles."""

import bpy
import numpy as np
import pytest

from tests.scenes.cycles import direct_light
from tests.scenes.parts.node_tree import made

from .squares import OUTPUTS, SQUARE, assert_as_in_cycles, centres, ours, see

PROPERTIES = {
    "number": 0.3,
    "whole": 3,
    "flag": True,
    "one": [0.25],
    "two": [0.1, 0.2],
    "three": [0.1, 0.2, 0.4],
    "four": [0.1, 0.2, 0.4, 0.5],
    "five": [0.1] * 5,
    "whole two": [1, 2],
    "text": "0.5",
    "group": {"number": 0.7},
    "pass_index": "hides the number of that name",
    "mirror": 0.2,
}
PATHS = "color", "color[0]", "location", "hide_render", "matrix_world", "data", "name", 'data["of mesh"]', '["number"]'
OF_MESH = "of mesh", "texspace_size"


def test_properties_of_objects(device, squares):
    """Also of their meshes."""
    names = [*PROPERTIES, *PATHS, *OF_MESH, "missing", ""]
    for each in squares("OBJECT", names):
        for name, value in PROPERTIES.items():
            each[name] = value
        each.color, each.pass_index = (0.5, 0.6, 0.7, 0.8), 3
        each.data["of mesh"] = 0.6
        each.data["mirror"] = 0.9
    assert_as_in_cycles(device, len(names), len(OUTPUTS))


def test_surfaces_reflect_properties(device, squares):
    """The color of a diffuse surface, below a sun."""
    for k, each in enumerate(squares("OBJECT", ["tint", "color"], ["Color", "Alpha"], "ShaderNodeBsdfDiffuse")):
        each["tint"] = [0.2 * k, 0.3, 0.4, 0.5]
        each.color = 0.5, 0.6, 0.2 * k, 0.8
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy = 3.0
    bpy.context.scene.collection.objects.link(sun)
    assert_as_in_cycles(device, 2, 2)


def test_instancers_of_objects_are_the_objects(device, squares):
    for each in squares("INSTANCER", ["number", "color", "missing"]):
        each["number"], each.color = 0.3, (0.5, 0.6, 0.7, 0.8)
    assert_as_in_cycles(device, 3, len(OUTPUTS))


def test_properties_of_view_layers(device, squares):
    """Before those of the scene, and these before those of its world."""
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("world")
    for k, owner in enumerate((bpy.context.view_layer, scene, scene.world)):
        for name in ("layer", "scene", "world")[k:]:
            owner[name] = [0.1 + 0.2 * k, 0.3]
    names = ["layer", "scene", "world", "frame_current", "use_sky", "render.resolution_percentage", "missing"]
    squares("VIEW_LAYER", names)
    assert_as_in_cycles(device, len(names), len(OUTPUTS))


@pytest.mark.parametrize("type_", ["OBJECT", "INSTANCER"])
def test_properties_of_collection_instances(device, squares, add, type_):
    """The instancer's before the object's, then those of the mesh."""
    names, inner = ["first", "second", "third", "missing"], bpy.data.collections.new("inner")
    for k, each in enumerate(squares(type_, names)):
        bpy.context.scene.collection.objects.unlink(each)
        inner.objects.link(each)
        each["first"] = each["second"] = 0.3 + 0.05 * k
        each.data["second"] = each.data["third"] = 0.4 + 0.05 * k
    for k in range(2):
        empty = add("empty", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", inner
        empty["first"], empty.location = 0.1 + k, (k * len(names), 0.0, 0.0)
    assert_as_in_cycles(device, 2 * len(names), len(OUTPUTS))


def test_properties_of_particles(device, squares, add):
    """Those of the particles' settings come first."""
    (shown,) = squares("INSTANCER", ["first"], ["Color"])
    emitter = add("emitter", SQUARE)
    emitter.modifiers.new("particles", "PARTICLE_SYSTEM")
    settings = emitter.particle_systems[0].settings
    settings.count, settings.render_type, settings.instance_object = 30, "OBJECT", shown
    settings.frame_start = settings.frame_end = settings.normal_factor = 0.0
    settings.particle_size, settings.use_rotations, settings.rotation_mode = 1.0, True, "NONE"
    emitter.show_instancer_for_render = emitter.show_instancer_for_viewport = False
    shown.location.x = 5.0
    emitter.location = -0.5, 0.5, 0.0
    settings["first"], emitter["first"], shown["first"] = 0.3, 0.5, 0.6
    assert_as_in_cycles(device, 1, 1)


def test_surfaces_are_as_transparent_as_properties_say(device, squares):
    """Before a background that emits light."""

    def make(tree):
        alpha = tree.add("ShaderNodeAttribute", attribute_type="OBJECT", attribute_name="alpha").outputs["Fac"]
        inputs = {0: alpha, 1: tree.add("ShaderNodeBsdfTransparent"), 2: tree.add("ShaderNodeEmission")}
        return tree.add("ShaderNodeMixShader", inputs)

    material = made(make)
    for k, each in enumerate(squares("OBJECT", ["first", "second", "third"], ["Color"])):
        each["alpha"] = 0.2 + 0.3 * k
        each.data.materials[0] = material
    bpy.context.scene.world = bpy.data.worlds.new("world")
    bpy.context.scene.world.use_nodes = True
    bpy.context.scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = 0.2, 0.5, 0.3, 1.0
    assert_as_in_cycles(device, 3, 1, samples=400)


def test_instances_light_surfaces_by_their_own_attributes(device, squares, add):
    """Two squares of one mesh that face a wall each, and that the camera does not see."""
    first, second = squares("OBJECT", ["light", "other"], ["Color"])
    second.data = first.data
    for k, each in enumerate((first, second)):
        each["light"] = [10.0, 3.0, 5.0 * k]
        each.location, each.visible_camera = (2.0 * k, 0.0, 1.0), False
        add("wall", SQUARE).location = 2.0 * k, 0.0, 0.0
    see(3, 1)
    picture, _ = ours(device, 32)
    truth = direct_light(512)
    assert np.allclose(centres(picture), centres(truth), rtol=0.03, atol=0.01)
