# SPDX-License-Identifier: GPL-3.0-or-later
"""Base colours and images of real node trees."""

import math

import bpy
import numpy as np
import pytest

from ism_addon.blender.sync.materials import images
from ism_addon.scene import Encoding


@pytest.fixture
def surface(add):
    """surface(shader="ShaderNodeBsdfPrincipled"): adds a material to a square; returns it and its surface's node."""
    thing = add("Square")

    def surface(shader="ShaderNodeBsdfPrincipled"):
        material = bpy.data.materials.new("Paint")
        if material.node_tree is None:
            material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        output, node = tree.nodes.new("ShaderNodeOutputMaterial"), tree.nodes.new(shader)
        tree.links.new(node.outputs[0], output.inputs["Surface"])
        thing.data.materials.append(material)
        return material, node

    return surface


def new_image(name="Picture", pixels=((1, 0, 0, 1), (0, 1, 0, 1), (0, 0, 1, 1), (0.5, 0.5, 0.5, 1)), **options):
    """A generated image, 2 × 2."""
    image = bpy.data.images.new(name, 2, 2, alpha=True, **options)
    image.pixels.foreach_set(np.float32(pixels).reshape(-1))
    return image


def texture(material, socket, image):
    """A new Image Texture node that is linked to the socket."""
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    material.node_tree.links.new(node.outputs["Color"], socket)
    return node


STORED = [[[255, 0, 0, 255], [0, 255, 0, 255]], [[0, 0, 255, 255], [128, 128, 128, 255]]]


@pytest.mark.parametrize(
    ("shader", "socket"), [("ShaderNodeBsdfPrincipled", "Base Color"), ("ShaderNodeBsdfDiffuse", "Color")]
)
def test_the_shaders_colour_is_the_base_colour(surface, read_scene, shader, socket):
    _, node = surface(shader)
    node.inputs[socket].default_value = (0.5, 0.25, 0.125, 1)
    materials = read_scene().materials
    assert materials.base_color.tolist() == [[0.5, 0.25, 0.125]]
    assert materials.image.tolist() == [-1]
    assert (materials.base_color.dtype, materials.image.dtype) == (np.float32, np.int32)


def test_no_material_and_an_empty_slot_are_grey(add, read_scene):
    add("Bare")
    add("Empty slot").data.materials.append(None)
    scene = read_scene()
    assert scene.materials.base_color.tolist() == [[np.float32(0.8)] * 3]
    assert scene.instances.mesh.tolist() == [0, 1]


@pytest.mark.skipif(bpy.app.version >= (5, 0), reason="since Blender 5.0 a material always has nodes")
def test_without_nodes_the_viewport_colour_is_drawn(add, read_scene):
    material = bpy.data.materials.new("Plain")
    material.diffuse_color = (0.5, 0.25, 0.125, 1)
    add("Square").data.materials.append(material)
    assert read_scene().materials.base_color.tolist() == [[0.5, 0.25, 0.125]]


def test_an_override_of_the_view_layer_replaces_all_materials(surface, read_scene):
    surface()
    override = bpy.data.materials.new("Override")
    if override.node_tree is None:
        override.use_nodes = True
    override.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0, 1, 0, 1)
    bpy.context.view_layer.material_override = override
    assert read_scene().materials.base_color.tolist() == [[0, 1, 0]]


def test_another_surface_is_drawn_in_the_viewport_colour_and_reported(surface, read_scene):
    material, _ = surface("ShaderNodeBsdfToon")
    material.diffuse_color = (0.5, 0.25, 0.125, 1)
    scene = read_scene()
    assert scene.materials.base_color.tolist() == [[0.5, 0.25, 0.125]]
    assert scene.warnings == (
        "Materials whose surface is a node 'Toon BSDF' are drawn in their viewport colour: 'Paint'.",
    )


def test_a_material_without_a_surface_is_black(surface, read_scene):
    material, node = surface()
    material.node_tree.nodes.remove(node)
    assert read_scene().materials.base_color.tolist() == [[0, 0, 0]]


def test_colours_are_read_through_reroutes_and_muted_nodes(surface, read_scene):
    material, node = surface()
    tree = material.node_tree
    rgb, gamma, reroute = (tree.nodes.new(name) for name in ("ShaderNodeRGB", "ShaderNodeGamma", "NodeReroute"))
    rgb.outputs[0].default_value = (0.25, 0.5, 0.75, 1)
    gamma.mute = True
    tree.links.new(rgb.outputs[0], gamma.inputs["Color"])
    tree.links.new(gamma.outputs[0], reroute.inputs[0])
    tree.links.new(reroute.outputs[0], node.inputs["Base Color"])
    scene = read_scene()
    assert scene.materials.base_color.tolist() == [[0.25, 0.5, 0.75]]
    assert scene.warnings == ()


def test_a_muted_link_is_ignored(surface, read_scene):
    material, node = surface()
    node.inputs["Base Color"].default_value = (0.5, 0.5, 0.5, 1)
    texture(material, node.inputs["Base Color"], new_image())
    node.inputs["Base Color"].links[0].is_muted = True
    assert read_scene().images == ()


def test_a_node_that_is_not_known_leaves_the_plain_colour_and_is_reported(surface, read_scene):
    material, node = surface()
    node.inputs["Base Color"].default_value = (0.5, 0.25, 0.125, 1)
    info = material.node_tree.nodes.new("ShaderNodeParticleInfo")
    material.node_tree.links.new(info.outputs["Location"], node.inputs["Base Color"])
    scene = read_scene()
    assert scene.materials.base_color.tolist() == [[0.5, 0.25, 0.125]]
    assert scene.warnings == (
        "Materials whose Base Color is given by a node 'Particle Info' have the socket's own value: 'Paint'.",
    )


def test_a_colour_component_that_is_no_number_or_too_large_is_grey(surface, read_scene):
    _, node = surface()
    node.inputs["Base Color"].default_value = (math.nan, 0.5, 3e38, 1)
    assert read_scene().materials.base_color.tolist() == [[np.float32(0.8), 0.5, np.float32(0.8)]]


def test_a_generated_image_is_the_base_colour(surface, read_scene):
    material, node = surface("ShaderNodeBsdfDiffuse")
    texture(material, node.inputs["Color"], new_image())
    scene = read_scene()
    assert scene.materials.image.tolist() == [0]
    assert scene.images[0].texels.tolist() == STORED
    assert scene.images[0].texels.dtype == np.uint8
    assert scene.images[0].repeat
    assert scene.warnings == ()


def test_packed_and_saved_images_are_the_same(surface, read_scene, tmp_path):
    material, node = surface()
    path = str(tmp_path / "picture.png")
    image = new_image(pixels=[(0.2, 0.4, 0.6, 1)] * 4)
    image.filepath_raw, image.file_format = path, "PNG"
    image.save()
    loaded = bpy.data.images.load(path)
    texture(material, node.inputs["Base Color"], loaded)
    assert read_scene().images[0].texels.tolist() == [[[51, 102, 153, 255]] * 2] * 2
    loaded.pack()
    (tmp_path / "picture.png").unlink()
    loaded.reload()
    assert read_scene().images[0].texels.tolist() == [[[51, 102, 153, 255]] * 2] * 2


MAGENTA = [[1.0, 0.0, 1.0]]


def test_a_missing_image_is_magenta_and_reported(surface, read_scene, tmp_path):
    material, node = surface()
    path = str(tmp_path / "gone.png")
    image = new_image()
    image.filepath_raw, image.file_format = path, "PNG"
    image.save()
    node.inputs["Base Color"].default_value = (0.5, 0.25, 0.125, 1)
    texture(material, node.inputs["Base Color"], bpy.data.images.load(path))
    (tmp_path / "gone.png").unlink()
    bpy.data.images["gone.png"].reload()
    scene = read_scene()
    assert scene.materials.base_color.tolist() == MAGENTA
    assert scene.materials.image.tolist() == [-1]
    assert scene.images == ()
    assert scene.warnings == ("Images that are missing or cannot be read are magenta, as in Blender: 'gone.png'.",)


def test_an_image_that_is_missing_twice_is_reported_once(surface, read_scene, tmp_path):
    image = bpy.data.images.new("Gone", 2, 2)
    image.source, image.filepath = "FILE", str(tmp_path / "gone.png")
    for _ in range(2):
        material, node = surface()
        texture(material, node.inputs["Base Color"], image)
    assert read_scene().warnings == ("Images that are missing or cannot be read are magenta, as in Blender: 'Gone'.",)


def test_an_image_texture_without_an_image_is_magenta(surface, read_scene):
    material, node = surface()
    texture(material, node.inputs["Base Color"], None)
    scene = read_scene()
    assert scene.materials.image.tolist() == [-1] and scene.materials.base_color.tolist() == MAGENTA
    assert scene.warnings == ("Image Textures without an image are magenta, as in Blender: 'Paint'.",)


def test_images_are_shared_except_between_extensions(surface, read_scene):
    image = new_image()
    for extension in ("REPEAT", "EXTEND", "REPEAT"):
        material, node = surface("ShaderNodeBsdfDiffuse")
        texture(material, node.inputs["Color"], image).extension = extension
    scene = read_scene()
    assert scene.materials.image.tolist() == [0, 1, 0]
    assert [each.repeat for each in scene.images] == [True, False]


@pytest.mark.parametrize("on_black", [False, True])
def test_an_image_of_several_portions_is_rounded_to_8_bits(add, on_black):
    image = bpy.data.images.new("Large", 300, 2 * images.TEXELS_AT_A_TIME // 300, alpha=True)
    stored = np.random.default_rng(0).integers(0, 256, (*reversed(image.size), 4))
    stored[: len(stored) // 2, :, 3] = 255  # one portion is opaque, another one is transparent
    image.pixels.foreach_set((stored / np.float32(255.0)).astype(np.float32).reshape(-1))
    if on_black:
        stored[..., :3] = np.rint(stored[..., :3] * stored[..., 3:] / 255.0)
    assert np.array_equal(images.read(image, on_black=on_black).texels, stored)


def test_texels_are_encoded_as_images_store_them(add):
    grey = [(0.18, 0.18, 0.18, 1)] * 4
    floats = new_image(pixels=[(0.18, 0.18, 0.18, 1), (7, -1, math.nan, 1)] * 2, float_buffer=True)
    assert images.read(floats).encoding == Encoding.FLOAT
    assert images.read(floats).texels.tolist() == [[[np.float16(0.18)] * 3 + [1.0], [7.0, -1.0, 0.0, 1.0]]] * 2
    data = new_image(pixels=grey, is_data=True)
    assert images.read(data).encoding == Encoding.LINEAR
    assert images.read(data).texels[0, 0, 0] == round(0.18 * 255)
    assert images.read(new_image(pixels=grey)).texels[0, 0, 0] == round(0.18 * 255)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_channel_without_any_number_is_black(add, value):
    image = new_image(pixels=[(value, 2.0, 0.5, 1)] * 4, float_buffer=True)
    assert images.read(image).texels.tolist() == [[[0.0, 2.0, 0.5, 1.0]] * 2] * 2


def test_colours_are_premultiplied_unless_the_alpha_is_linked(surface, read_scene):
    material, node = surface()
    image_node = texture(material, node.inputs["Base Color"], new_image(pixels=[(1, 0.5, 0, 0.5)] * 4))
    assert read_scene().images[0].texels[0, 0].tolist() == [128, 64, 0, 128]
    material.node_tree.links.new(image_node.outputs["Alpha"], node.inputs["Alpha"])
    assert read_scene().images[0].texels[0, 0].tolist() == [255, 128, 0, 128]
    image_node.image.alpha_mode = "CHANNEL_PACKED"
    assert images.read(image_node.image, on_black=True).texels[0, 0].tolist() == [255, 128, 0, 128]


def test_an_unknown_colour_space_is_reported(surface, read_scene):
    material, node = surface()
    image = new_image()
    image.colorspace_settings.name = "Linear CIE-XYZ D65"
    texture(material, node.inputs["Base Color"], image)
    assert read_scene().warnings == ("Images in a colour space that is not known are taken for sRGB: 'Picture'.",)


def test_texture_mappings_that_are_not_drawn_are_reported(surface, read_scene):
    material, node = surface()
    image_node = texture(material, node.inputs["Base Color"], new_image())
    tree = material.node_tree
    coordinates, mapping = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeMapping")
    tree.links.new(coordinates.outputs["UV"], image_node.inputs["Vector"])
    assert read_scene().warnings == ()
    image_node.projection, image_node.extension = "BOX", "CLIP"
    assert read_scene().warnings == ()
    tree.links.new(mapping.outputs["Vector"], image_node.inputs["Vector"])
    image_node.projection = "FLAT"
    assert read_scene().warnings == ()
    tree.links.new(tree.nodes.new("ShaderNodeParticleInfo").outputs["Location"], image_node.inputs["Vector"])
    placed = "Textures placed by a node 'Particle Info' lie on the active UV map as it is: 'Paint'."
    assert read_scene().warnings == (placed,)


def test_many_names_become_one_short_sentence(add, read_scene):
    for letter in "ABCDE":
        add(letter).is_holdout = True
    assert read_scene().warnings == ("Holdouts are drawn as plain surfaces: 'A', 'B', 'C', 2 more.",)
