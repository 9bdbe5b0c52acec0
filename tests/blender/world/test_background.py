# SPDX-License-Identifier: GPL-3.0-or-later
"""What the camera sees of worlds, beside Cycles."""

import bpy
import numpy as np
import pytest

from tests.benchmark.files import FILTER_WIDTH, our_render
from tests.scenes.cycles import direct_light
from tests.scenes.parts.node_tree import world_of

pytestmark = pytest.mark.usefixtures("registered")

#: Samples of ours and of Cycles', and the largest RMSE over the mean.
SAMPLES, TRUTH, BOUND = 256, 256, 0.01


def texels(width, height):
    """An image of random colors, up to 20 times as bright as white."""
    colors = np.ones((height, width, 4), np.float32)
    colors[..., :3] = 20.0 * np.random.default_rng(0).random((height, width, 3))
    image = bpy.data.images.new("texels", width, height, float_buffer=True)
    image.pixels.foreach_set(colors.ravel())
    image.pack()
    return image


def environment(tree, **properties):
    turned = tree.add("ShaderNodeMapping", {0: coordinate(tree, "Generated"), "Rotation": (0.3, 0.2, 0.7)})
    return tree.add("ShaderNodeTexEnvironment", {"Vector": turned}, image=texels(32, 16), **properties)


def coordinate(tree, name):
    return tree.add("ShaderNodeTexCoord").outputs[name]


def background(tree, color, strength=1.0):
    return tree.add("ShaderNodeBackground", {"Color": color, "Strength": strength})


def by_ray(tree):
    is_camera = tree.add("ShaderNodeLightPath").outputs["Is Camera Ray"]
    one, other = background(tree, (0.1, 0.9, 0.3, 1.0)), background(tree, environment(tree), 0.5)
    return tree.add("ShaderNodeMixShader", {"Fac": is_camera, 1: one, 2: other})


def added(tree):
    one, other = background(tree, (0.1, 0.2, 0.3, 1.0)), background(tree, coordinate(tree, "Normal"), -0.1)
    return tree.add("ShaderNodeAddShader", {0: one, 1: other})


def clouds(tree):
    noise = tree.add("ShaderNodeTexNoise", {"Scale": 4.0}).outputs["Fac"]
    ramp = tree.add("ShaderNodeValToRGB", {"Fac": noise})
    return background(tree, ramp.outputs["Color"])


def from_object(tree):
    empty = bpy.data.objects.new("Empty", None)
    empty.location, empty.rotation_euler, empty.scale = (0.2, -0.3, 0.1), (0.5, 0.6, 0.7), (2.0, 1.0, 0.5)
    bpy.context.scene.collection.objects.link(empty)
    coordinates = tree.add("ShaderNodeTexCoord", object=empty)
    return background(tree, tree.add("ShaderNodeTexGradient", {0: coordinates.outputs["Object"]}).outputs["Color"])


def sky(tree, model, **properties):
    node = tree.add("ShaderNodeTexSky", sky_type=model)
    for name, value in {
        "sun_elevation": 0.5,
        "sun_rotation": 2.2,
        "sun_direction": (0.5, -0.5, 0.7),
        **properties,
    }.items():
        if hasattr(node, name):
            setattr(node, name, value)
    return background(tree, node, 0.1)


#: The models of this release.
SKIES = [each.identifier for each in bpy.types.ShaderNodeTexSky.bl_rna.properties["sky_type"].enum_items]

WORLDS = {
    "an image all around": lambda tree: background(tree, environment(tree), 2.0),
    "its texels": lambda tree: background(tree, environment(tree, interpolation="Closest")),
    "a mirror ball": lambda tree: background(tree, environment(tree, projection="MIRROR_BALL")),
    "no image": lambda tree: background(tree, tree.add("ShaderNodeTexEnvironment")),
    "another one for the camera": by_ray,
    "two shaders": added,
    "an emission": lambda tree: tree.add("ShaderNodeEmission", {"Color": environment(tree)}),
    "noise": clouds,
    "coordinates of an object": from_object,
    **{
        f"coordinates {name}": lambda tree, name=name: background(tree, coordinate(tree, name))
        for name in ("Generated", "Camera", "Window", "Reflection")
    },
    **{f"the sky {model}": lambda tree, model=model: sky(tree, model, sun_disc=False) for model in SKIES},
    "what a shader that is missing leaves": lambda tree: tree.add("ShaderNodeBsdfDiffuse"),
}


@pytest.fixture
def view(add, empty_scene):
    """A camera that looks up aslant."""
    empty_scene.camera = add("Camera", bpy.data.cameras.new("Camera"))
    empty_scene.camera.rotation_euler, empty_scene.camera.location = (1.9, 0.1, 0.5), (3.0, 2.0, 1.0)
    empty_scene.camera.data.lens = 18.0
    render = empty_scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = 48, 32, 100
    render.filter_size = FILTER_WIDTH
    return empty_scene.camera


def both(scene, make):
    """The pictures of this engine and of Cycles of a world."""
    scene.world = world_of(make)
    ours, _ = our_render(SAMPLES)
    return ours, direct_light(TRUTH, FILTER_WIDTH)[..., :3]


@pytest.mark.parametrize("name", WORLDS)
def test_the_camera_sees_what_it_sees_in_cycles(view, empty_scene, name):
    ours, theirs = both(empty_scene, WORLDS[name])
    assert np.sqrt(np.mean((ours - theirs) ** 2)) <= BOUND * max(float(np.abs(theirs).mean()), 1e-3)


def test_an_orthographic_camera_sees_one_direction(view, empty_scene):
    view.data.type = "ORTHO"
    ours, theirs = both(empty_scene, WORLDS["an image all around"])
    assert np.abs(ours - theirs).max() <= 1e-3 * theirs.max() and theirs.max() > 0.0
