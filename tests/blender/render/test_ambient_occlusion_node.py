# SPDX-License-Identifier: GPL-3.0-or-later
"""The node Ambient Occlusion, compared with Cycles."""

import bpy
import numpy as np
import pytest

from ism_addon.blender.engine import statistics
from tests.benchmark.files import our_render
from tests.scenes.cycles import direct_light

FILTER_WIDTH = 1.5
TRUTH = 64

pytestmark = pytest.mark.usefixtures("registered")


@pytest.fixture
def scene(empty_scene):
    """A plane, a cube and a ball under a sun without shadows. They have one material."""
    material = bpy.data.materials.new("Aged")
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Specular IOR Level"].default_value = 0.0
    for add, options in (
        (bpy.ops.mesh.primitive_plane_add, {"size": 8.0}),
        (bpy.ops.mesh.primitive_cube_add, {"size": 1.0, "location": (0.0, 0.0, 0.5)}),
        (bpy.ops.mesh.primitive_uv_sphere_add, {"radius": 0.5, "location": (1.2, -0.3, 0.5)}),
    ):
        add(**options)
        bpy.context.object.data.materials.append(material)
    sun, camera = (
        bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN")),
        bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera")),
    )
    for each in (sun, camera):
        empty_scene.collection.objects.link(each)
    sun.data.energy, sun.data.use_shadow, sun.rotation_euler = 3.0, False, (0.5, 0.3, 0.0)
    camera.location, camera.rotation_euler = (3.0, -5.0, 4.0), (0.9, 0.0, 0.55)
    empty_scene.camera = camera
    render = empty_scene.render
    render.resolution_x, render.resolution_y, render.filter_size = 96, 54, FILTER_WIDTH
    return empty_scene


def occlusion(**options):
    """A node Ambient Occlusion whose color is the material's, and the shader."""
    tree = bpy.data.materials["Aged"].node_tree
    node, shader = tree.nodes.new("ShaderNodeAmbientOcclusion"), tree.nodes["Principled BSDF"]
    node.inputs["Color"].default_value = (0.9, 0.6, 0.3, 1.0)
    for name, value in options.items():
        if name in node.inputs:
            node.inputs[name].default_value = value
        else:
            setattr(node, name, value)
    tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    return node, shader


def error(samples: int) -> float:
    ours, _ = our_render(samples)
    halves = [direct_light(TRUTH, FILTER_WIDTH, seed=seed)[..., :3] for seed in (1, 2)]
    square = ((ours - halves[0]) * (ours - halves[1])).mean()
    return float(np.sqrt(max(square, 0.0)) / np.mean(halves))


@pytest.mark.parametrize("method", ["RAY_TRACED", "SHADOW_MAPS"])
@pytest.mark.parametrize("options", [{"Distance": 1.0}, {"Distance": 0.5, "inside": True}, {"samples": 1}], ids=str)
def test_it_is_as_in_cycles(scene, options, method):
    scene.ism.shadow.method = method
    occlusion(**options)
    assert error(64) < 0.015


def test_its_normal_is_used(scene):
    node, _ = occlusion(Distance=1.0)
    tree = node.id_data
    normal = tree.nodes.new("ShaderNodeCombineXYZ")
    for name, value in zip("XYZ", (0.6, 0.0, 0.8), strict=True):
        normal.inputs[name].default_value = value
    tree.links.new(normal.outputs[0], node.inputs["Normal"])
    assert error(64) < 0.015


def test_other_materials_trace_nothing(scene):
    occlusion()
    our_render(1)
    assert statistics()["passes"]["TracingGBuffer"]["drawn"] == 1
    bpy.data.materials["Aged"].node_tree.links.clear()
    our_render(1)
    passes = statistics()["passes"]
    assert "TracingGBuffer" not in passes and passes["BuildTLAS"]["drawn"] == 0


def test_what_is_not_drawn_of_it_is_said(scene, read_scene):
    node, shader = occlusion(only_local=True)
    assert read_scene().warnings == ("Ambient Occlusion nodes of Only Local see all objects: 'Aged'.",)
    node.only_local = False
    assert read_scene().warnings == ()
    node.id_data.links.new(node.outputs["AO"], shader.inputs["Alpha"])
    sentence = "Ambient Occlusion nodes do not darken what materials emit and what passes through them: 'Aged'."
    assert read_scene().warnings == (sentence,)
