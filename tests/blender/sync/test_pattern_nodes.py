# SPDX-License-Identifier: GPL-3.0-or-later
"""What procedural textures, projections and nodes of objects read of a scene."""

import bpy
import numpy as np
import pytest

from ism_addon.blender.sync.geometry.random_ids import random_number


@pytest.fixture
def show(add):
    """show(node type): the node, whose first output is the colour of an object."""
    material = bpy.data.materials.new("Paint")
    material.use_nodes = True
    tree = material.node_tree
    add("Square").data.materials.append(material)

    def show(type_: str) -> bpy.types.Node:
        node = tree.nodes.new(type_)
        tree.links.new(node.outputs[0], tree.nodes["Principled BSDF"].inputs["Base Color"])
        return node

    return show


def test_generated_coordinates_are_read_only_where_a_texture_has_no_others(show, read_scene):
    node = show("ShaderNodeTexMagic")
    (mesh,) = read_scene().meshes
    assert mesh.attributes.shape == (2, 3, 1, 4)
    tree = node.id_data
    tree.links.new(tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"], node.inputs["Vector"])
    (mesh,) = read_scene().meshes
    assert mesh.attributes.size == 0


def test_a_projected_image_is_another_operation(show, read_scene):
    node = show("ShaderNodeTexImage")
    node.image = bpy.data.images.new("Picture", 2, 2)
    (graph,) = read_scene().graphs
    assert graph.uses("image_linear")
    node.projection = "BOX"
    (graph,) = read_scene().graphs
    assert graph.uses("image_box")


def test_coordinates_of_another_object_follow_it(show, add, latest_scene):
    node = show("ShaderNodeTexCoord")
    node.object = add("Other", None)
    tree = node.id_data
    tree.links.new(node.outputs["Object"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    before = latest_scene()
    assert before.graphs[0].uses("coordinate_of_object")
    node.object.location = 1.0, 2.0, 3.0
    after = latest_scene()
    assert after.graphs == before.graphs
    moved = after.materials.constants - before.materials.constants
    assert sorted(moved[np.nonzero(moved)].tolist()) == [-3.0, -2.0, -1.0]


#: As Cycles draws them.
@pytest.mark.parametrize(("name", "number"), [("ObjectInfo Zwölf plane output 5", 0.147425)])
def test_the_random_number_of_a_name(name, number):
    assert random_number(None, name) == pytest.approx(number, abs=1e-6)


def test_the_random_number_of_an_instance():
    assert (random_number(0, ""), random_number(-1, ""), random_number(2**32 - 1, "")) == (0.0, 1.0, 1.0)


def test_instances_have_the_colour_of_what_makes_them(show, add, read_scene, empty_scene):
    show("ShaderNodeObjectInfo")
    tree = bpy.data.materials["Paint"].node_tree
    tree.links.new(tree.nodes["Object Info"].outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    thing, holder, inner = bpy.data.objects["Square"], add("Holder", None), bpy.data.collections.new("Inner")
    empty_scene.collection.objects.unlink(thing)
    inner.objects.link(thing)
    holder.instance_type, holder.instance_collection = "COLLECTION", inner
    thing.color, holder.color = (0.0, 0.0, 1.0, 1.0), (1.0, 0.5, 0.0, 1.0)
    assert read_scene().instances.color.tolist() == [[1.0, 0.5, 0.0, 1.0]]
