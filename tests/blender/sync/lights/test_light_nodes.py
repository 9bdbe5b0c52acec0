# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights with nodes, portals, lights without diffuse light, and sheared lights, compared with Cycles."""

import math
from dataclasses import replace

import bpy
import numpy as np
import pytest

from ism_addon.blender.sync import camera, scene_reader
from ism_addon.gpu.renderer import Profile, Renderer
from ism_addon.settings import SSAO, Quality, Settings, Shadow
from tests.scenes.cycles import PIXEL_CENTRES, direct_light


def node_tree(light):
    if light.node_tree is None or not light.use_nodes:
        light.use_nodes = True
    return light.node_tree


def draw(device, samples=1):
    """Our picture of the open scene, (16,16,3). Shadow rays correct it if there are several samples."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    renderer = Renderer(device)
    quality = Quality(samples=samples, virtual_lights=4)
    settings = Settings(shadow=Shadow(enabled=samples > 1), ssao=SSAO(enabled=False), quality=quality)
    view = replace(camera.final_view(depsgraph), filter_width=PIXEL_CENTRES)  # as the reference
    scene, profile = scene_reader.scene(depsgraph), Profile()
    for sample in range(samples):
        for _ in renderer.sample(scene, view, settings, sample, profile):
            pass
    picture = renderer.picture()[..., :3]
    renderer.release()
    return picture


def test_a_plain_emission_is_read(device, light_object, read_scene):
    emission = node_tree(light_object.data).nodes["Emission"]
    emission.inputs["Color"].default_value, emission.inputs["Strength"].default_value = (1, 0.5, 0.25, 1), 3.0
    assert read_scene().warnings == ()
    assert np.allclose(draw(device).mean((0, 1)) / direct_light(16)[..., :3].mean((0, 1)), 1.0, atol=0.01)


def test_the_colour_of_a_black_body_and_quadratic_falloff(device, light_object, read_scene):
    tree = node_tree(light_object.data)
    body, falloff = tree.nodes.new("ShaderNodeBlackbody"), tree.nodes.new("ShaderNodeLightFalloff")
    body.inputs["Temperature"].default_value, falloff.inputs["Strength"].default_value = 3000.0, 2.0
    emission = tree.nodes["Emission"]
    tree.links.new(body.outputs["Color"], emission.inputs["Color"])
    tree.links.new(falloff.outputs["Quadratic"], emission.inputs["Strength"])
    assert read_scene().warnings == ()
    assert np.allclose(draw(device).mean((0, 1)) / direct_light(16)[..., :3].mean((0, 1)), 1.0, atol=0.01)


LIGHTS = {
    "point": ("POINT", {"shadow_soft_size": 0.0}),
    "sphere": ("POINT", {"shadow_soft_size": 0.5, "use_soft_falloff": False}),
    "disk": ("POINT", {"shadow_soft_size": 0.5, "use_soft_falloff": True}),
    "spot": ("SPOT", {"shadow_soft_size": 0.0, "spot_size": 2.0}),
    "area": ("AREA", {"size": 1.0}),
}


@pytest.mark.parametrize(
    ("output", "smooth"), [("Linear", 0.0), ("Constant", 0.0), ("Quadratic", 4.0), ("Linear", 4.0)]
)
@pytest.mark.parametrize("name", LIGHTS)
def test_falloff_equals_that_of_cycles(device, light_object, read_scene, name, output, smooth):
    kind, properties = LIGHTS[name]
    light = light_object.data = bpy.data.lights.new("lamp", kind)
    for key, value in properties.items():
        setattr(light, key, value)
    light.energy, light.use_shadow = 50.0, True
    tree = node_tree(light)
    falloff, emission = tree.nodes.new("ShaderNodeLightFalloff"), tree.nodes["Emission"]
    falloff.inputs["Strength"].default_value, falloff.inputs["Smooth"].default_value = 2.0, smooth
    tree.links.new(falloff.outputs[output], emission.inputs["Strength"])
    assert read_scene().warnings == ()
    ours, theirs = draw(device, 128), direct_light(512)[..., :3]
    assert theirs.mean() > 0.01
    # Of lights with a size the falloff is that of one distance, until shadow rays correct it.
    hard = properties.get("shadow_soft_size") == 0.0
    assert np.abs(ours - theirs).mean() < (0.001 if hard else 0.008) * theirs.mean()


@pytest.mark.parametrize("socket", ["Strength", "Smooth"])
def test_falloff_that_varies_and_that_of_suns_are_reported(light_object, read_scene, socket):
    tree = node_tree(light_object.data)
    falloff, emission = tree.nodes.new("ShaderNodeLightFalloff"), tree.nodes["Emission"]
    tree.links.new(falloff.outputs["Linear"], emission.inputs["Strength"])
    tree.links.new(tree.nodes.new("ShaderNodeTexNoise").outputs[0], falloff.inputs[socket])
    assert "'Noise Texture'" in read_scene().warnings[0]
    tree.links.remove(falloff.inputs[socket].links[0])
    assert read_scene().warnings == ()
    light_object.data.type = "SUN"
    assert "'Light Falloff'" in read_scene().warnings[0]


def test_an_empty_tree_gives_no_light(light_object, read_scene):
    node_tree(light_object.data).nodes.clear()
    assert len(read_scene().lights.shape) == 0
    assert not direct_light(1)[..., :3].any()


def test_other_light_nodes_are_reported(light_object, read_scene):
    tree = node_tree(light_object.data)
    emission = tree.nodes["Emission"]
    tree.links.new(tree.nodes.new("ShaderNodeTexChecker").outputs["Color"], emission.inputs["Color"])
    tree.links.new(tree.nodes.new("ShaderNodeTexNoise").outputs["Fac"], emission.inputs["Strength"])
    scene = read_scene()
    assert len(scene.lights.shape) == 1
    assert scene.warnings == (
        "Lights coloured by a node 'Checker Texture' shine in the plain colour of its socket: 'Lamp'.",
        "Lights whose strength a node 'Noise Texture' gives have the plain one of its socket: 'Lamp'.",
    )
    add = tree.nodes.new("ShaderNodeAddShader")
    tree.links.new(add.outputs[0], tree.nodes["Light Output"].inputs["Surface"])
    assert read_scene().warnings == ("Lights whose surface is a node 'Add Shader' shine as if they had none: 'Lamp'.",)


@pytest.mark.parametrize("reason", ["portal", "no diffuse"])
def test_what_lights_nothing_diffuse_in_cycles_is_left_out_silently(light_object, read_scene, reason):
    light_object.data.cycles.is_portal, light_object.visible_diffuse = reason == "portal", reason == "portal"
    scene = read_scene()
    assert len(scene.lights.shape) == 0
    assert scene.warnings == ()
    assert direct_light(4)[..., :3].max() < 1e-6


@pytest.mark.parametrize("visible", [True, False])
def test_a_light_may_be_visible_to_the_camera(light_object, read_scene, visible):
    light_object.visible_camera = visible
    assert read_scene().lights.visible_camera.tolist() == [visible]


@pytest.mark.parametrize("shape", ["ELLIPSE", "RECTANGLE"])
def test_sheared_lights_keep_their_power(device, light_object, add, read_scene, shape):
    """In Cycles, so do ellipses by light sampling. Rays that hit them use another shape there, so MIS is off."""
    parent = add("Parent", None)
    parent.scale = 1, 2, 1
    light_object.data.shape, light_object.parent, light_object.rotation_euler = shape, parent, (0, 0, 0.6)
    scene = read_scene()
    lights = scene.lights
    area = np.linalg.norm(np.cross(lights.axis_u[0], lights.axis_v[0])) * (math.pi / 4 if shape == "ELLIPSE" else 1)
    assert np.allclose(lights.emission[0] * math.pi * area, 100.0)
    sentence = "Sheared area lights shine evenly from what they look like, which Cycles' do not: 'Lamp'."
    assert scene.warnings == (sentence,)
    if shape == "ELLIPSE":
        light_object.data.cycles.use_multiple_importance_sampling = False
        ratio = draw(device)[..., 0] / direct_light(256)[..., 0]
        assert abs(np.median(ratio) - 1.0) < 0.002
