# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes whose emission is a node graph light others by their texture, beside Cycles."""

from dataclasses import replace

import bpy
import numpy as np
import pytest

from ism_addon.blender.sync import camera, scene_reader
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.resources import BAKED_EMISSION
from ism_addon.settings import Method, Shadow
from tests.scenes.cycles import direct_light
from tests.scenes.parts.node_tree import made
from tests.support.small_scenes import with_quality

from .test_transparency import FILTER_WIDTH, SETTINGS, SIDE


def image_node(tree, colors):
    """Of an image with these colors (H,W,3), each a square."""
    texels = np.ones((*colors.shape[:2], 4), np.float32)
    texels[..., :3] = colors
    image = bpy.data.images.new("texels", *colors.shape[1::-1], float_buffer=True)
    image.pixels.foreach_set(texels.ravel())
    image.pack()
    return tree.add("ShaderNodeTexImage", image=image, interpolation="Closest")


def emission(tree, color, strength=4.0):
    return tree.add("ShaderNodeEmission", {"Color": color, "Strength": strength})


def halves(tree):
    """Red and blue."""
    return emission(tree, image_node(tree, np.array([[(1.0, 0.02, 0.02), (0.02, 0.02, 1.0)]] * 2)))


def squares(tree):
    """Of many colors."""
    return emission(tree, image_node(tree, np.random.default_rng(0).random((8, 8, 3)) ** 4))


def noise(tree):
    """Of several islands."""
    value = tree.add("ShaderNodeTexNoise", {"Scale": 2.5}).outputs[0]
    above = tree.add("ShaderNodeMath", {0: value, 1: 0.5}, operation="SUBTRACT", use_clamp=True)
    strength = tree.add("ShaderNodeMath", {0: above, 1: 60.0}, operation="MULTIPLY")
    return emission(tree, (1.0, 0.6, 0.2, 1.0), strength)


def attribute(tree):
    return emission(tree, tree.add("ShaderNodeVertexColor", layer_name="tint").outputs["Color"])


def transparent(tree):
    """Half of it is seen, and lights."""
    black = (0.0, 0.0, 0.0, 1.0)
    color = image_node(tree, np.array([[(1.0, 0.1, 0.1), (0.1, 1.0, 0.1)]] * 2))
    inputs = {"Base Color": black, "Emission Color": color, "Emission Strength": 4.0, "Alpha": 0.5}
    return tree.add("ShaderNodeBsdfPrincipled", inputs | {"Specular IOR Level": 0.0})


def one_sided(tree):
    """From the back alone."""
    back = tree.add("ShaderNodeNewGeometry").outputs["Backfacing"]
    return emission(tree, (1.0, 1.0, 1.0, 1.0), tree.add("ShaderNodeMath", {0: back, 1: 4.0}, operation="MULTIPLY"))


@pytest.fixture
def room(empty_scene):
    """room(make, …): a floor with a block, below an emissive mesh whose material `make` makes; returns that object."""

    def build(make, roughness=None, place=(0.0, 0.0, 1.5), size=2.0, cells=4, ball=False, rotation=(0.0, 0.0, 0.0)):
        def grey(tree):
            if roughness is None:
                return tree.add("ShaderNodeBsdfDiffuse")
            return tree.add("ShaderNodeBsdfPrincipled", {"Roughness": roughness, "Base Color": (0.2, 0.2, 0.2, 1.0)})

        bpy.ops.mesh.primitive_plane_add(size=8.0)
        bpy.context.object.data.materials.append(made(grey))
        bpy.ops.mesh.primitive_cube_add(size=0.4, location=(0.4, -0.2, 0.2))
        bpy.context.object.data.materials.append(made(grey))
        if ball:
            bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12, radius=0.5, location=(-0.4, 0.0, 0.8))
        else:
            bpy.ops.mesh.primitive_grid_add(
                x_subdivisions=cells, y_subdivisions=cells, size=size, location=place, rotation=rotation
            )
            colors = bpy.context.object.data.color_attributes.new("tint", "FLOAT_COLOR", "POINT")
            places = np.array([vertex.co for vertex in bpy.context.object.data.vertices])
            rgba = np.ones((len(places), 4), np.float32)
            rgba[:, :3] = np.stack([places[:, 0] > 0.0, places[:, 1] > 0.0, places[:, 0] < -0.5], 1)
            colors.data.foreach_set("color", rgba.ravel())
        light = bpy.context.object
        light.data.materials.append(made(make))
        empty_scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        empty_scene.collection.objects.link(empty_scene.camera)
        empty_scene.camera.location, empty_scene.camera.rotation_euler = (0.0, -3.5, 2.6), (0.85, 0.0, 0.0)
        empty_scene.render.resolution_x = empty_scene.render.resolution_y = SIDE
        empty_scene.render.filter_size = FILTER_WIDTH
        return light

    return build


def read():
    """The scene and the view."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return scene_reader.scene(depsgraph), camera.final_view(depsgraph)


def drawn(device, settings=SETTINGS, renderer=None, scene=None):
    """(H,W,3), the renderer and its profile."""
    (own, view), renderer, profile = read(), renderer or Renderer(device), Profile()
    for sample in range(settings.quality.samples):
        for _ in renderer.sample(scene or own, view, settings, sample, profile):
            pass
    return renderer.picture()[..., :3], renderer, profile


def blurred(picture):
    """Means of squares of 4×4 pixels, in which little noise is left."""
    return picture.reshape(SIDE // 4, 4, SIDE // 4, 4, 3).mean((1, 3))


def error(picture, truth):
    """RMSE over the mean, of squares."""
    return float(np.sqrt(np.mean((blurred(picture) - blurred(truth)) ** 2)) / truth.mean())


CASES = {
    "halves": (halves, {}),
    "few pieces": (halves, {"cells": 1}),
    "many squares": (squares, {}),
    "a ball of noise": (noise, {"ball": True}),
    "a color attribute": (attribute, {}),
    "below gloss": (halves, {"cells": 1, "roughness": 0.4}),
    "many squares below gloss": (squares, {"roughness": 0.4}),
    "half transparent": (transparent, {}),
    "from the back": (one_sided, {"rotation": (0.4, 0.0, 0.0)}),
    "touching the floor": (squares, {"place": (0.0, 0.3, 0.5), "size": 1.0, "rotation": (np.pi / 2.0, 0.0, 0.0)}),
}


@pytest.mark.parametrize("name", CASES)
def test_textures_light_as_in_cycles(device, room, name):
    make, options = CASES[name]
    room(make, **options).visible_camera = False
    assert read()[0].warnings == ()
    picture, renderer, _ = drawn(device)
    truth = direct_light(1024, FILTER_WIDTH)[..., :3]
    assert error(picture, truth) < 0.03, "most of which is the noise of Cycles, and of 128 filtered samples"
    assert np.allclose(picture.mean((0, 1)), truth.mean((0, 1)), rtol=0.01)
    renderer.release()


def test_shadow_maps_have_the_light_of_the_texture(device, room):
    room(squares).visible_camera = False
    settings = replace(with_quality(SETTINGS, samples=16), shadow=Shadow(method=Method.SHADOW_MAPS))
    picture, renderer, _ = drawn(device, settings)
    assert error(picture, direct_light(1024, FILTER_WIDTH)[..., :3]) < 0.03
    renderer.release()


def test_a_bright_spot_is_sampled_by_importance(device, room, empty_scene):
    """Against a mesh of the spot's size. Sixteen samples of the whole image would miss it nearly always."""
    colors = np.zeros((64, 64, 3))
    colors[8:12, 48:52] = 100.0
    light = room(lambda tree: emission(tree, image_node(tree, colors), 1.0))
    light.visible_camera = False
    picture, renderer, _ = drawn(device, with_quality(SETTINGS, samples=16))
    uniform = direct_light(16, FILTER_WIDTH)[..., :3]
    light.data.materials[0] = made(lambda tree: emission(tree, (0.0, 0.0, 0.0, 1.0)))
    corner, size = np.array([48.0, 8.0]) / 32.0 - 1.0, 4.0 / 32.0
    bpy.ops.mesh.primitive_plane_add(size=size, location=(*(corner + size / 2.0), 1.499))
    bpy.context.object.data.materials.append(made(lambda tree: emission(tree, (1.0, 1.0, 1.0, 1.0), 100.0)))
    bpy.context.object.visible_camera = False
    truth = direct_light(256, FILTER_WIDTH)[..., :3]
    ours, theirs = (float(np.sqrt(np.mean((each - truth) ** 2)) / truth.mean()) for each in (picture, uniform))
    print("error of 16 samples:", ours, "by area alone:", theirs)
    assert ours < 0.05 and ours < 0.05 * theirs
    renderer.release()


def test_an_even_graph_is_drawn_as_an_even_emission(device, room):
    light = room(lambda tree: emission(tree, image_node(tree, np.full((2, 2, 3), 0.5))))
    settings = with_quality(SETTINGS, samples=2)
    graph, renderer, _ = drawn(device, settings)
    lights = renderer.last[0].scene.lights
    assert len(renderer.graph[BAKED_EMISSION].pieces) == 1 and not lights.varies.any() and not len(lights.colors)
    light.data.materials[0] = made(lambda tree: emission(tree, (0.5, 0.5, 0.5, 1.0)))
    plain, other, profile = drawn(device, settings)
    assert np.array_equal(graph, plain)
    assert other.graph.get(BAKED_EMISSION) is None and profile.rows["BakeEmission"].drawn == 0
    for each in (renderer, other):
        each.release()


def test_a_changed_constant_is_baked_again_and_nothing_else(device, room):
    light, settings = room(squares), with_quality(SETTINGS, samples=1)
    scene, _ = read()
    first, renderer, _ = drawn(device, settings, scene=scene)
    baked = renderer.graph[BAKED_EMISSION]
    again, _, profile = drawn(device, settings, renderer, replace(scene, world=replace(scene.world)))
    assert np.array_equal(first, again) and renderer.graph[BAKED_EMISSION] is baked
    assert profile.rows["UploadLights"].drawn == 0
    tree = light.data.materials[0].node_tree
    next(node for node in tree.nodes if node.bl_idname == "ShaderNodeEmission").inputs["Strength"].default_value = 8.0
    brighter, *_ = drawn(device, settings, renderer)
    assert renderer.graph[BAKED_EMISSION] is not baked
    assert np.allclose(brighter, 2.0 * first, rtol=1e-3, atol=1e-5)
    renderer.release()


def test_a_mesh_out_of_view_lights_by_its_texture(device, room, empty_scene):
    light = room(halves, place=(0.0, 0.0, 3.0))
    empty_scene.camera.location, empty_scene.camera.rotation_euler = (0.0, 0.0, 2.0), (0.0, 0.0, 0.0)
    picture, renderer, _ = drawn(device)
    assert renderer.last[0].scene.lights.varies.tolist() == [True]
    assert error(picture, direct_light(1024, FILTER_WIDTH)[..., :3]) < 0.01
    bpy.data.objects.remove(light)
    assert not drawn(device, with_quality(SETTINGS, samples=1), renderer)[0].any()
    renderer.release()


def test_a_distant_mesh_lights_itself_as_in_cycles(device, room):
    """Its parts are no larger than pixels, so the irradiance changes within them."""
    light = room(lambda tree: principled_emission(tree, 0.2))
    light.location = 0.0, 0.0, -1000.0
    bpy.ops.mesh.primitive_monkey_add(size=2.0, rotation=(-0.3, 0.0, 0.4))
    bpy.context.object.data.materials.append(light.data.materials[0])
    bpy.context.scene.camera.location = 0.0, -16.0, 0.0
    bpy.context.scene.camera.rotation_euler = np.pi / 2, 0.0, 0.0
    picture, *_ = drawn(device)
    truth = direct_light(1024, FILTER_WIDTH)[..., :3]
    lit = truth > 0.1
    assert np.sqrt(np.mean((picture - truth)[lit] ** 2)) / truth[lit].mean() < 0.02


def principled_emission(tree, strength):
    """A white diffuse shader that emits, too."""
    inputs = {"Base Color": (1.0, 1.0, 1.0, 1.0), "Emission Color": (1.0, 1.0, 1.0, 1.0), "Specular IOR Level": 0.0}
    return tree.add("ShaderNodeBsdfPrincipled", inputs | {"Emission Strength": strength})
