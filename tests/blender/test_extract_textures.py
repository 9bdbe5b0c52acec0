# SPDX-License-Identifier: GPL-3.0-or-later
"""Where textures lie, and which frame of them is drawn."""

import bpy
import numpy as np
import pytest
from bpy.app.handlers import depsgraph_update_post

from ism_addon.blender import extract


@pytest.fixture
def textured(add):
    """textured(image, layers): a square whose material has the image; its Image Texture node."""

    def textured(image, layers=("UV",)):
        thing = add("Square")
        for number, name in enumerate(layers):
            thing.data.uv_layers.new(name=name).uv.foreach_set("vector", np.float32([number / 4] * 8))
        material = bpy.data.materials.new("Paint")
        material.use_nodes = True
        tree = material.node_tree
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        tree.links.new(node.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
        thing.data.materials.append(material)
        return node

    return textured


def test_a_uv_map_node_names_the_layer_and_can_be_edited(textured, extracted):
    node = textured(bpy.data.images.new("Picture", 2, 2), ("First", "Second"))
    uv_map = node.id_data.nodes.new("ShaderNodeUVMap")
    node.id_data.links.new(uv_map.outputs["UV"], node.inputs["Vector"])
    bpy.context.view_layer.update()
    reader = extract.Reader()
    followed = [reader.read(bpy.context.evaluated_depsgraph_get())]
    handler = lambda _scene, depsgraph: followed.append(reader.read(depsgraph))  # noqa: E731
    depsgraph_update_post.append(handler)
    for name, value in (("Second", 0.25), ("First", 0.0), ("Second", 0.25), ("Gone", 0.0)):
        uv_map.uv_map = name
        bpy.context.view_layer.update()
        for scene in (followed[-1], extracted()):
            assert np.all(scene.meshes[0].uvs == value)
            assert scene.warnings == ()
    depsgraph_update_post.remove(handler)
