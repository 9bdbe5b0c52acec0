# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees as graphs: groups and muted nodes, trees that cannot be drawn, and changes of constants."""

import bpy
import numpy as np
import pytest

from ism_addon.blender.sync import scene_reader
from ism_addon.blender.sync.node_graphs import links
from tests.benchmark.nodes import measure
from tests.scenes.nodes.case import NodeCase
from tests.scenes.nodes.cases import cases

from .test_materials import new_image, texture
from .test_materials import surface as surface

#: RMSE of a node beside Cycles' picture, of colours from 0 to 1.
MOST = 0.01


def test_the_nodes_of_each_type_look_like_cycles(registered):
    """The first case of each node; `dev.py bench nodes` renders all."""
    first: dict[str, NodeCase] = {}
    for case in cases():
        first.setdefault(case.type, case)
    errors = measure(list(first.values()), samples=32)
    assert {name: error for name, error in errors.items() if error > MOST} == {}


def node(tree, type_, **inputs):
    added = tree.nodes.new(f"ShaderNode{type_}")
    for name, value in inputs.items():
        added.inputs[name].default_value = value
    return added


def color_of(read_scene):
    """The only material's base color, which no graph gives."""
    scene = read_scene()
    assert scene.graphs == () and scene.warnings == ()
    return scene.materials.base_color[0]


def group(name, socket_type="NodeSocketColor"):
    """A node group with one input and one output of a type, and nothing in between."""
    tree = bpy.data.node_groups.new(name, "ShaderNodeTree")
    tree.interface.new_socket("In", in_out="INPUT", socket_type=socket_type)
    tree.interface.new_socket("Out", in_out="OUTPUT", socket_type=socket_type)
    return tree, tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")


def test_groups_in_groups(surface, read_scene):
    material, shader = surface("ShaderNodeBsdfDiffuse")
    inner, inner_input, inner_output = group("Inner")
    gamma = node(inner, "Gamma", Gamma=2.0)
    inner.links.new(inner_input.outputs[0], gamma.inputs["Color"])
    inner.links.new(gamma.outputs[0], inner_output.inputs[0])
    outer, outer_input, outer_output = group("Outer")
    used = [outer.nodes.new("ShaderNodeGroup") for _ in range(2)]
    outer.links.new(outer_input.outputs[0], used[0].inputs[0]) if used[0].inputs else None
    for each in used:
        each.node_tree = inner
    outer.links.new(outer_input.outputs[0], used[0].inputs[0])
    outer.links.new(used[0].outputs[0], used[1].inputs[0])
    outer.links.new(used[1].outputs[0], outer_output.inputs[0])
    instance = material.node_tree.nodes.new("ShaderNodeGroup")
    instance.node_tree = outer
    instance.inputs[0].default_value = (0.5, 0.25, 1.0, 1.0)
    material.node_tree.links.new(instance.outputs[0], shader.inputs["Color"])
    assert np.allclose(color_of(read_scene), (0.5**4, 0.25**4, 1.0), atol=1e-6)


def test_two_instances_of_a_group_have_their_own_inputs(surface, read_scene):
    material, shader = surface("ShaderNodeBsdfDiffuse")
    tree = material.node_tree
    inner, inner_input, inner_output = group("Inner")
    inner.links.new(inner_input.outputs[0], inner_output.inputs[0])
    mix = node(tree, "Mix")
    mix.data_type, mix.inputs["Factor"].default_value = "RGBA", 0.25
    for name, color in (("A_Color", (1.0, 0.0, 0.0, 1.0)), ("B_Color", (0.0, 1.0, 0.0, 1.0))):
        instance = tree.nodes.new("ShaderNodeGroup")
        instance.node_tree = inner
        instance.inputs[0].default_value = color
        socket = next(each for each in mix.inputs if each.identifier == name)
        tree.links.new(instance.outputs[0], socket)
    output = next(each for each in mix.outputs if each.identifier == "Result_Color")
    tree.links.new(output, shader.inputs["Color"])
    assert np.allclose(color_of(read_scene), (0.75, 0.25, 0.0), atol=1e-6)


def test_the_sockets_of_groups_convert_values(surface, read_scene):
    """A color through a number is grey, as in Cycles."""
    material, shader = surface("ShaderNodeBsdfDiffuse")
    inner, inner_input, inner_output = group("Number", "NodeSocketFloat")
    inner.links.new(inner_input.outputs[0], inner_output.inputs[0])
    instance, rgb = (material.node_tree.nodes.new(name) for name in ("ShaderNodeGroup", "ShaderNodeRGB"))
    instance.node_tree, rgb.outputs[0].default_value = inner, (1.0, 0.0, 0.0, 1.0)
    material.node_tree.links.new(rgb.outputs[0], instance.inputs[0])
    material.node_tree.links.new(instance.outputs[0], shader.inputs["Color"])
    assert np.allclose(color_of(read_scene), 0.2126, atol=1e-3)


def test_shaders_in_groups_are_mixed(surface, read_scene):
    material, _ = surface("ShaderNodeBsdfDiffuse")
    inner, _, inner_output = group("Shader", "NodeSocketShader")
    diffuse = [node(inner, "BsdfDiffuse", Color=(*color, 1.0)) for color in np.eye(3)[:2]]
    mix = node(inner, "MixShader", Fac=0.25)
    for k, each in enumerate(diffuse):
        inner.links.new(each.outputs[0], mix.inputs[1 + k])
    inner.links.new(mix.outputs[0], inner_output.inputs[0])
    instance = material.node_tree.nodes.new("ShaderNodeGroup")
    instance.node_tree = inner
    output = next(each for each in material.node_tree.nodes if each.bl_idname == "ShaderNodeOutputMaterial")
    material.node_tree.links.new(instance.outputs[0], output.inputs["Surface"])
    assert np.allclose(color_of(read_scene), (0.75, 0.25, 0.0), atol=1e-6)


def test_a_group_without_a_tree_leaves_the_own_value(surface, read_scene):
    material, shader = surface("ShaderNodeBsdfDiffuse")
    shader.inputs["Color"].default_value = (0.5, 0.25, 0.125, 1.0)
    instance = material.node_tree.nodes.new("ShaderNodeGroup")
    instance.node_tree, _, _ = group("Lost")
    material.node_tree.links.new(instance.outputs[0], shader.inputs["Color"])
    bpy.data.node_groups.remove(instance.node_tree)
    assert np.allclose(color_of(read_scene), (0.5, 0.25, 0.125))


def test_a_circle_of_nodes_is_cut(surface, read_scene):
    material, shader = surface("ShaderNodeBsdfDiffuse")
    tree = material.node_tree
    one, other = node(tree, "Gamma"), node(tree, "Gamma")
    tree.links.new(one.outputs[0], other.inputs["Color"])
    tree.links.new(other.outputs[0], one.inputs["Color"])
    tree.links.new(other.outputs[0], shader.inputs["Color"])
    assert np.isfinite(read_scene().materials.base_color).all()


@pytest.mark.parametrize(("type_", "is_drawn"), [("Invert", True), ("Gamma", False)])
def test_long_graphs_are_drawn_unless_compilers_would_take_seconds(surface, read_scene, type_, is_drawn):
    material, shader = surface("ShaderNodeBsdfDiffuse")
    tree, previous = material.node_tree, None
    image = texture(material, shader.inputs["Color"], new_image())
    for _ in range(500):
        added = node(tree, type_)
        tree.links.new((previous or image).outputs[0], added.inputs["Color"])
        previous = added
    tree.links.new(previous.outputs[0], shader.inputs["Color"])
    scene = read_scene()
    if is_drawn:
        assert scene.warnings == () and len(scene.graphs[0].instructions) == 500 + len(IMAGE_GRAPH)
    else:
        warning = "Materials with too many nodes for one shader are drawn in one colour: 'Paint'."
        assert scene.warnings == (warning,) and scene.graphs == ()


#: Operations of an image that is reflected.
IMAGE_GRAPH = "uv_map", "image_linear", "color_of", "geometry_normal", "closure_diffuse"


def test_a_thousand_nodes_are_followed(surface):
    material, shader = surface("ShaderNodeBsdfDiffuse")
    tree, previous = material.node_tree, None
    for _ in range(1000):
        added = node(tree, "Gamma")
        if previous is not None:
            tree.links.new(previous.outputs[0], added.inputs["Color"])
        previous = added
    tree.links.new(previous.outputs[0], shader.inputs["Color"])
    assert len(list(links.Links().upstream((), shader.inputs["Color"]))) == 1000


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -1e38])
def test_constants_that_are_no_numbers(surface, read_scene, value):
    material, shader = surface("ShaderNodeBsdfDiffuse")
    image = texture(material, shader.inputs["Color"], new_image())
    gamma = node(material.node_tree, "Gamma", Gamma=value)
    material.node_tree.links.new(image.outputs[0], gamma.inputs["Color"])
    material.node_tree.links.new(gamma.outputs[0], shader.inputs["Color"])
    scene = read_scene()
    assert np.isfinite(scene.materials.constants).all() and np.isfinite(scene.materials.base_color).all()


def test_materials_of_the_same_nodes_share_a_graph(surface, read_scene):
    for gamma in (1.5, 2.0):
        material, shader = surface("ShaderNodeBsdfDiffuse")
        image = texture(material, shader.inputs["Color"], new_image(f"Picture {gamma}"))
        changed = node(material.node_tree, "Gamma", Gamma=gamma)
        material.node_tree.links.new(image.outputs[0], changed.inputs["Color"])
        material.node_tree.links.new(changed.outputs[0], shader.inputs["Color"])
    scene = read_scene()
    assert len(scene.graphs) == 1 and scene.materials.graph.tolist() == [0, 0]
    assert len(scene.images) == 2


def test_while_a_slider_is_dragged_the_graph_stays_the_same(surface):
    """Also where the slider passes 0 and 1, at which the mix could be left out."""
    material, shader = surface("ShaderNodeBsdfDiffuse")
    tree = material.node_tree
    image = texture(material, shader.inputs["Color"], new_image())
    mix = node(tree, "MixRGB", Fac=0.0)
    tree.links.new(image.outputs[0], mix.inputs["Color1"])
    tree.links.new(mix.outputs[0], shader.inputs["Color"])
    reader, graphs = scene_reader.Reader(), []
    depsgraph = bpy.context.evaluated_depsgraph_get()
    assert reader.read(depsgraph).graphs == (), "an image alone"
    handler = lambda _scene, changed: graphs.append(reader.read(changed).graphs)  # noqa: E731
    bpy.app.handlers.depsgraph_update_post.append(handler)
    try:
        for factor in (0.25, 0.5, 0.0, 1.0, 0.75):
            mix.inputs["Fac"].default_value = factor
            bpy.context.view_layer.update()
    finally:
        bpy.app.handlers.depsgraph_update_post.remove(handler)
    assert len(graphs) == 5 and len(set(graphs)) == 1 and len(graphs[0]) == 1


def test_attributes_are_read_only_for_graphs_that_need_them(surface, read_scene):
    material, shader = surface("ShaderNodeBsdfDiffuse")
    assert read_scene().meshes[0].attributes.shape == (0, 3, 0, 4)
    coordinates = node(material.node_tree, "TexCoord")
    material.node_tree.links.new(coordinates.outputs["Generated"], shader.inputs["Color"])
    scene = read_scene()
    attributes = scene.meshes[0].attributes
    assert attributes.shape == (2, 3, 1, 4) and len(scene.meshes[0].uvs) == 0
    expected = scene.meshes[0].positions[scene.meshes[0].triangles]
    assert np.allclose(attributes[:, :, 0, :2], expected[..., :2], atol=1e-6)
    assert scene.instances.color.shape == (0, 4)
    material.node_tree.links.new(node(material.node_tree, "ObjectInfo").outputs["Color"], shader.inputs["Color"])
    scene = read_scene()
    assert scene.meshes[0].attributes.shape == (0, 3, 0, 4) and scene.instances.color.tolist() == [[1.0] * 4]
