# SPDX-License-Identifier: GPL-3.0-or-later
"""Transparent surfaces beside Cycles: what the camera sees through them, and their shadows."""

import bmesh
import bpy
import numpy as np
import pytest

from ism_addon.blender.sync import camera, scene_reader
from ism_addon.gpu.passes.emission.filter_emission import FilterEmission
from ism_addon.gpu.renderer import Profile, Renderer
from ism_addon.settings import SSAO, Quality, Settings
from tests.pictures.opengl.test_ray_samplers import samplers_of
from tests.scenes.cycles import direct_light
from tests.scenes.parts.node_tree import made
from tests.scenes.worlds import maps

SIDE = 48
FILTER_WIDTH = 1.5
SETTINGS = Settings(quality=Quality(samples=128, error_threshold=0.0), ssao=SSAO(enabled=False))


def principled(tree, alpha):
    """A diffuse Principled BSDF of an alpha."""
    inputs = {"Base Color": (0.7, 0.2, 0.1, 1.0), "Alpha": alpha, "Specular IOR Level": 0.0}
    return tree.add("ShaderNodeBsdfPrincipled", inputs)


def mixed(tree, factor, color):
    """A transparent shader and a diffuse one."""
    transparent = tree.add("ShaderNodeBsdfTransparent", {"Color": (*color, 1.0)})
    return tree.add("ShaderNodeMixShader", {0: factor, 1: transparent, 2: tree.add("ShaderNodeBsdfDiffuse")})


def checkered(tree):
    """An alpha of 0 and 1."""
    alpha = np.kron(np.indices((4, 4)).sum(0) % 2, np.ones((8, 8)))
    image = bpy.data.images.new("squares", *alpha.shape, alpha=True)
    image.pixels.foreach_set(np.repeat(alpha[..., None], 4, axis=2).astype(np.float32).ravel())
    image.pack()
    return principled(tree, tree.add("ShaderNodeTexImage", image=image).outputs["Alpha"])


def only_seen(tree):
    """Opaque for the camera, transparent for shadow rays."""
    return mixed(tree, tree.add("ShaderNodeLightPath").outputs["Is Camera Ray"], (1.0, 1.0, 1.0))


def only_shadow(tree):
    """The reverse."""
    return mixed(tree, tree.add("ShaderNodeLightPath").outputs["Is Shadow Ray"], (1.0, 1.0, 1.0))


SURFACES = {
    "alpha": lambda tree: principled(tree, 0.4),
    "alpha below 0": lambda tree: principled(tree, -1.0),
    "alpha above 1": lambda tree: principled(tree, 2.0),
    "mixed": lambda tree: mixed(tree, 0.25, (0.8, 0.8, 0.8)),
    "checkered": checkered,
    "only seen": only_seen,
    "only shadow": only_shadow,
    "noise": lambda tree: principled(tree, tree.add("ShaderNodeTexNoise", {"Scale": 3.0}).outputs[0]),
}


RED, BLUE = (0.9, 0.2, 0.05, 1.0), (0.1, 0.3, 0.8, 1.0)


def glass(tree, color):
    """A transparent shader of a color."""
    return tree.add("ShaderNodeBsdfTransparent", {"Color": color})


def stained(tree):
    """A window of four colors."""
    texels = np.ones((2, 2, 4), np.float32)
    texels[..., :3] = [[(1.0, 0.1, 0.0), (0.1, 0.6, 0.1)], [(0.0, 0.2, 0.9), (0.9, 0.7, 0.1)]]
    image = bpy.data.images.new("window", 2, 2, float_buffer=True)
    image.pixels.foreach_set(texels.ravel())
    image.pack()
    return glass(tree, tree.add("ShaderNodeTexImage", image=image, interpolation="Closest"))


def shining(tree):
    """Red glass that emits light."""
    light = tree.add("ShaderNodeEmission", {"Color": (0.3, 0.5, 1.0, 1.0), "Strength": 2.0})
    return tree.add("ShaderNodeMixShader", {0: 0.4, 1: light, 2: glass(tree, RED)})


def added(tree, shader, inputs):
    """A shader that is added to a transparent one, which lets all light pass."""
    return tree.add("ShaderNodeAddShader", {0: glass(tree, (1.0, 1.0, 1.0, 1.0)), 1: tree.add(shader, inputs)})


def half_covered(tree):
    """Red glass beside a shader of an alpha."""
    inputs = {0: 0.5, 1: principled(tree, 0.4), 2: glass(tree, (0.8, 0.1, 0.1, 1.0))}
    return tree.add("ShaderNodeMixShader", inputs)


COLORED = {
    "glass": lambda tree: glass(tree, RED),
    "one channel": lambda tree: glass(tree, (1.0, 0.0, 0.0, 1.0)),
    "mixed": lambda tree: mixed(tree, 0.25, RED[:3]),
    "stained": stained,
    "half covered": half_covered,
    "shining": shining,
    "added light": lambda tree: added(tree, "ShaderNodeEmission", {"Color": RED, "Strength": 0.5}),
    "added diffuse": lambda tree: added(tree, "ShaderNodeBsdfDiffuse", {"Color": (0.1, 0.2, 0.4, 1.0)}),
}


@pytest.fixture
def pane(empty_scene, add):
    """pane(make, count): a floor under panes of a material that `make` makes, an area light and a camera."""

    def build(make, count=1) -> bpy.types.Material:
        floor = add("floor", ([(-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0)], [(0, 1, 2, 3)]))
        floor.data.materials.append(made(lambda tree: tree.add("ShaderNodeBsdfDiffuse")))
        material = made(make)
        for k in range(count):
            z = 0.4 + 0.05 * k
            each = add("pane", ([(-0.8, -0.8, z), (0.8, -0.8, z), (0.8, 0.8, z), (-0.8, 0.8, z)], [(0, 1, 2, 3)]))
            each.data.uv_layers.new()
            each.data.materials.append(material)
        light = bpy.data.lights.new("lamp", "AREA")
        light.size, light.energy = 0.6, 60.0
        lamp = add("lamp", light)
        lamp.location = 0.8, 0.0, 2.5
        data = bpy.data.cameras.new("camera")
        empty_scene.camera = add("camera", data)
        empty_scene.camera.location, empty_scene.camera.rotation_euler = (0.0, -3.0, 3.0), (0.785, 0.0, 0.0)
        empty_scene.render.resolution_x = empty_scene.render.resolution_y = SIDE
        empty_scene.render.filter_size = FILTER_WIDTH
        return material

    return build


def ours(device, samples=SETTINGS.quality.samples):
    """(H,W,4), and the reader's warnings."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    scene = scene_reader.scene(depsgraph)
    renderer, view = Renderer(device), camera.final_view(depsgraph)
    for sample in range(samples):
        for _ in renderer.sample(scene, view, SETTINGS, sample, Profile()):
            pass
    picture = renderer.picture()
    renderer.release()
    return picture, scene.warnings


def error(device, samples=SETTINGS.quality.samples):
    """RMSE over the mean of Cycles' picture."""
    picture, warnings = ours(device, samples)
    assert warnings == ()
    truth = direct_light(256, FILTER_WIDTH)
    return float(np.sqrt(np.mean((picture - truth)[..., :3] ** 2)) / truth[..., :3].mean())


@pytest.mark.parametrize("name", SURFACES)
def test_surfaces_are_as_transparent_as_in_cycles(device, pane, name):
    pane(SURFACES[name])
    assert error(device) < 0.02


@pytest.mark.parametrize("name", COLORED)
def test_what_is_seen_through_surfaces_is_tinted_as_in_cycles(device, pane, name):
    pane(COLORED[name])
    assert error(device) < 0.02


def test_panes_behind_one_another_multiply_their_colors(device, pane):
    pane(COLORED["glass"], 2)
    bpy.data.objects["pane.001"].data.materials[0] = made(lambda tree: glass(tree, BLUE))
    assert error(device) < 0.02


@pytest.fixture
def sky():
    """A world of one color."""
    world = bpy.context.scene.world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = 0.5, 0.7, 0.9, 1.0


def test_the_background_is_tinted(device, pane, sky):
    pane(COLORED["stained"], 2)
    bpy.data.objects.remove(bpy.data.objects["floor"])
    assert error(device) < 0.02


def test_tints_cover_a_background_that_is_left_out(device, pane, sky):
    pane(COLORED["stained"])
    bpy.data.objects.remove(bpy.data.objects["floor"])
    bpy.context.scene.render.film_transparent = True
    (picture, _), truth = ours(device), direct_light(256, FILTER_WIDTH)
    assert np.abs(picture - truth).max() < 0.2
    assert np.isclose(picture[..., 3].mean(), truth[..., 3].mean(), rtol=0.02)


def test_emission_is_tinted(device, pane):
    """Of surfaces, and of a light behind the pane; but not of the one before it."""
    pane(COLORED["glass"])
    shining = made(lambda tree: tree.add("ShaderNodeEmission", {"Color": (0.6, 0.8, 1.0, 1.0)}))
    bpy.data.objects["floor"].data.materials[0] = shining
    for z in (0.2, 0.7):
        lamp = bpy.data.objects.new("bulb", bpy.data.lights.new("bulb", "POINT"))
        lamp.data.shadow_soft_size, lamp.data.energy, lamp.location = 0.1, 2.0, (0.0, 0.0, z)
        lamp.visible_camera = True
        bpy.context.scene.collection.objects.link(lamp)
    assert error(device) < 0.02


@pytest.mark.parametrize("name", ["glass", "stained", "half covered", "shining", "alpha"])
def test_edges_of_emission_behind_surfaces_are_filtered(device, monkeypatch, pane, name):
    """Of a surface far brighter than all else, before which there is a pane."""
    pane((COLORED | SURFACES)[name], 2)
    bright = bpy.data.objects["pane"]
    bright.data.materials[0] = made(lambda tree: tree.add("ShaderNodeEmission", {"Strength": 200.0}))
    bright.scale = 0.5, 0.3, 1.0
    filtered = error(device, 8)
    monkeypatch.setattr(FilterEmission, "needed", lambda *_: False)
    assert filtered < 0.45 * error(device, 8)


@pytest.mark.parametrize("name", ["glass", "stained"])
def test_tinted_pictures_have_the_mean_of_cycles_whatever_the_number_of_samples(device, pane, name):
    """Adaptive sampling has tiles take part in different numbers of samples."""
    pane(COLORED[name])
    truth = direct_light(256, FILTER_WIDTH)[..., :3].mean((0, 1))
    for samples in (4, 16, 64):
        picture, _ = ours(device, samples)
        assert np.allclose(picture[..., :3].mean((0, 1)), truth, rtol=0.02), samples


def test_shadows_of_panes_are_tinted(device, pane):
    pane(lambda tree: mixed(tree, 0.2, (0.9, 0.5, 0.1)), 2)
    for each in bpy.data.objects:
        each.visible_camera = each.name == "floor"
    assert error(device) < 0.02


def test_transparent_shadows_can_be_switched_off(device, pane):
    pane(SURFACES["alpha"]).use_transparent_shadow = False
    assert error(device) < 0.02


@pytest.mark.parametrize("bounces", [2, 3, 4])
def test_more_surfaces_than_bounces_are_opaque(device, pane, bounces):
    pane(lambda tree: mixed(tree, 0.0, (1.0, 1.0, 1.0)), 3)
    for each in bpy.data.objects:
        each.visible_camera = each.name == "floor"
    bpy.context.scene.cycles.transparent_max_bounces = bounces
    assert error(device) < 0.02


def everything(tree):
    """Principled with all lobes, whose color and alpha are an image's, and the coat an attribute of the object."""
    image = bpy.data.images.new("noise", 8, 8, alpha=True)
    image.pixels.foreach_set(np.random.default_rng(1).random(8 * 8 * 4).astype(np.float32))
    image.pack()
    texture = tree.add("ShaderNodeTexImage", image=image)
    coat = tree.add("ShaderNodeAttribute", attribute_type="OBJECT", attribute_name="coat").outputs["Fac"]
    lobes = {"Coat Weight": coat, "Sheen Weight": 0.5, "Anisotropic": 0.5, "Roughness": 0.3}
    outputs = {"Base Color": texture.outputs["Color"], "Alpha": texture.outputs["Alpha"]}
    return tree.add("ShaderNodeBsdfPrincipled", lobes | outputs)


def test_shaders_have_no_more_samplers_than_opengl_guarantees(device, pane, add):
    """With all lobes, alpha, a light whose irradiance is cached, and a world of an image."""
    pane(everything)
    ball = bpy.data.meshes.new("ball")
    shape = bmesh.new()
    bmesh.ops.create_icosphere(shape, subdivisions=3, radius=0.2)
    shape.to_mesh(ball)
    shape.free()
    ball.materials.append(made(lambda tree: tree.add("ShaderNodeEmission", {"Strength": 5.0})))
    add("ball", ball).location = 1.0, 0.0, 1.0
    bpy.context.scene.world = maps.world_with(maps.overcast(4))  # an image of floats, which shadows do not read
    device.forget_programs()
    ours(device, 3)
    samplers = [samplers_of(program) for program in device.programs.values()]
    assert max(map(len, samplers)) <= 16
    assert any({"irradiance_ratio", "coat", "rare_lobes", "byte_texels", "blas_nodes"} <= each for each in samplers)
