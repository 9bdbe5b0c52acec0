# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights with Image Texture nodes, compared with Cycles."""

import bpy
import numpy as np
import pytest

from ism_addon.blender.sync import scene_reader
from tests.blender.sync.lights.test_light_nodes import node_tree
from tests.blender.sync.lights.test_light_profiles import PLACES, assert_like_cycles


def pattern(height: int = 48, width: int = 64) -> np.ndarray:
    """(H,W,4): waves, of other colors in each corner. Cycles interpolates colors as they are stored, not light."""
    v, u = np.meshgrid(np.linspace(0.0, 1.0, height), np.linspace(0.0, 1.0, width), indexing="ij")
    waves = 0.7 + 0.3 * np.sin(15.0 * u + 4.0 * v) * np.cos(14.0 * v)
    return np.stack([waves * (0.2 + 0.8 * u), waves * (0.2 + 0.8 * v), 0.9 - 0.8 * u * v, np.ones_like(u)], -1)


def new_image(pixels: np.ndarray, **options) -> bpy.types.Image:
    height, width = pixels.shape[:2]
    image = bpy.data.images.new("pattern", width, height, alpha=True, **options)
    image.pixels.foreach_set(pixels.astype(np.float32).ravel())
    image.update()
    return image


@pytest.fixture
def texture(light_object):
    """An area light's Image Texture node of an image."""
    bpy.context.scene.cycles.light_sampling_threshold = 0.0  # else samples of dark pixels are noisy
    light_object.data.size, light_object.data.size_y, light_object.data.energy = 2.0, 3.0, 5.0
    light_object.location.z = 0.6
    tree = node_tree(light_object.data)
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = new_image(pattern())
    tree.links.new(node.outputs["Color"], tree.nodes["Emission"].inputs["Color"])
    return node


def make_spot(light_object, **values) -> None:
    light_object.data.type, light_object.location.z, light_object.data.energy = "SPOT", 2.0, 50.0
    for name, value in {"spot_size": 2.0, "spot_blend": 0.3, "shadow_soft_size": 0.0, **values}.items():
        setattr(light_object.data, name, value)


@pytest.mark.parametrize("place", PLACES)
def test_a_spot_projects_its_image_as_in_cycles(device, texture, light_object, read_scene, place):
    make_spot(light_object)
    for name, value in PLACES[place].items():
        setattr(light_object, name, value)
    assert read_scene().warnings == ()
    assert_like_cycles(device, 0.005)


@pytest.mark.parametrize("values", [{"spot_size": 3.0}, {"spot_size": 0.5}, {"shadow_soft_size": 0.3}], ids=str)
def test_other_spots(device, texture, light_object, values):
    make_spot(light_object, **values)
    if "shadow_soft_size" in values:
        assert_like_cycles(device, 0.02, 64, 256)
    else:
        assert_like_cycles(device, 0.005)


@pytest.mark.parametrize("place", ["above", "tilted", "mirrored"])
@pytest.mark.parametrize("shape", ["RECTANGLE", "ELLIPSE"])
def test_an_area_has_its_image_as_in_cycles(device, texture, light_object, read_scene, shape, place):
    light_object.data.shape = shape
    for name, value in PLACES[place].items():
        setattr(light_object, name, value)
    assert read_scene().warnings == ()
    # Tilted, it nearly touches the plane, where the image is seen in more detail than few points show.
    assert_like_cycles(device, 0.02 if place == "above" else 0.03, 128, 512)


def test_other_images(device, texture, light_object, read_scene):
    """One without repetition, whose stored values are linear, larger than lights have, and above 1."""
    make_spot(light_object)
    texture.extension = "EXTEND"
    texture.image = new_image(3.0 * pattern(80, 1100), float_buffer=True)
    (image,) = read_scene().light_images
    assert image.colors.shape == (74, 1024, 3) and image.colors.max() == 1.0 and not image.repeat
    assert_like_cycles(device, 0.01)


def test_strength_colour_and_falloff_multiply_it(device, texture, light_object, read_scene):
    make_spot(light_object)
    light_object.data.color = 1.0, 0.5, 0.2
    tree = light_object.data.node_tree
    falloff = tree.nodes.new("ShaderNodeLightFalloff")
    falloff.inputs["Strength"].default_value = 0.5
    tree.links.new(falloff.outputs["Linear"], tree.nodes["Emission"].inputs["Strength"])
    assert read_scene().warnings == ()
    assert_like_cycles(device, 0.005)


def test_lights_share_an_image_until_it_changes(texture, light_object, add, read_scene):
    add("Other", light_object.data)
    plain = add("Plain", bpy.data.lights.new("plain", "POINT"))
    plain.data.energy = 10.0
    scene = read_scene()
    assert sorted(scene.lights.image.tolist()) == [-1, 0, 0]
    assert len(scene.light_images) == 1


def test_an_animation_keeps_images(texture):
    reader, depsgraph = scene_reader.Reader(), bpy.context.evaluated_depsgraph_get()
    first = reader.read(depsgraph)
    reader.invalidate()
    again = reader.read(depsgraph, all_instances=True)
    assert again.light_images[0] is first.light_images[0] and again.lights is first.lights


def test_painting_changes_the_light(texture, latest_scene):
    assert latest_scene().light_images[0].colors.min() < 0.1
    texture.image.pixels.foreach_set(np.full(48 * 64 * 4, 0.5, np.float32))
    texture.image.update()
    texture.image.update_tag()
    assert latest_scene().light_images[0].colors.min() == 1.0


NO_IMAGE = "Lights whose Image Texture has no image, or one that cannot be read, are not coloured: 'Lamp'."
MAPPED = "Images of lights that are mapped otherwise lie across the whole light: 'Lamp'."


def test_what_is_not_drawn_is_said(texture, light_object, read_scene):
    image, texture.image = texture.image, None
    assert read_scene().warnings == (NO_IMAGE,)
    texture.image, texture.projection = image, "BOX"
    assert read_scene().warnings == (MAPPED,)
    texture.projection, texture.interpolation = "FLAT", "Closest"
    assert read_scene().warnings == ("Images of lights that are not interpolated are interpolated linearly: 'Lamp'.",)
    texture.interpolation = "Linear"
    coordinates = texture.id_data.nodes.new("ShaderNodeTexCoord")
    texture.id_data.links.new(coordinates.outputs["UV"], texture.inputs["Vector"])
    assert read_scene().warnings == ()
    texture.id_data.links.new(coordinates.outputs["Object"], texture.inputs["Vector"])
    assert read_scene().warnings == (MAPPED,)
    light_object.data.type = "POINT"
    plain = "Lights coloured by a node 'Image Texture' shine in the plain colour of its socket: 'Lamp'."
    assert read_scene().warnings == (plain,)


def test_a_black_image_is_dark(texture, read_scene):
    texture.image = new_image(np.zeros((4, 4, 4)))
    assert len(read_scene().lights.shape) == 0
