# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures of the tests of images."""

import bpy
import numpy as np
import pytest


@pytest.fixture
def textured(add):
    """textured(image, layers): makes a square whose material has the image; returns its Image Texture node."""

    def textured(image, layers=("UV",)):
        thing = add("Square")
        for index, name in enumerate(layers):
            thing.data.uv_layers.new(name=name).uv.foreach_set("vector", np.float32([(index + 1) / 4] * 8))
        material = bpy.data.materials.new("Paint")
        material.use_nodes = True
        tree = material.node_tree
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        tree.links.new(node.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
        thing.data.materials.append(material)
        return node

    return textured
