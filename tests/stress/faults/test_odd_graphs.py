# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials whose nodes nobody would make: the picture is finite, and only the object's own pixels change."""

import math
import time
from collections.abc import Callable

import bpy
import numpy as np
import pytest

from tests.scenes.small import box_over_plane
from tests.stress.pictures.into_blender import into_blender, out_of_blender
from tests.support.small_scenes import SMALL_SETTINGS, draw

Tree = bpy.types.NodeTree
Node = bpy.types.Node


def noise(tree: Tree) -> Node:
    """A node that no constant can stand for."""
    return tree.nodes.new("ShaderNodeTexNoise")


def into_base_color(tree: Tree, output: bpy.types.NodeSocket) -> None:
    tree.links.new(output, tree.nodes["Principled BSDF"].inputs["Base Color"])


def group(name: str, socket_type: str) -> tuple[Tree, Node, Node]:
    """A group of one input and one output of a type."""
    inner = bpy.data.node_groups.new(name, "ShaderNodeTree")
    inner.interface.new_socket("In", in_out="INPUT", socket_type=socket_type)
    inner.interface.new_socket("Out", in_out="OUTPUT", socket_type=socket_type)
    return inner, inner.nodes.new("NodeGroupInput"), inner.nodes.new("NodeGroupOutput")


def instance(tree: Tree, inner: Tree) -> Node:
    """A node of a group, unless Blender refuses to make it."""
    added = tree.nodes.new("ShaderNodeGroup")
    added.node_tree = inner
    return added


def groups_in_a_circle(tree: Tree) -> None:
    """Blender refuses to close it; if it did not, reading would not end."""
    (one, one_input, one_output), (other, other_input, other_output) = (
        group(name, "NodeSocketColor") for name in ("One", "Other")
    )
    for outer, inner, start, end in ((one, other, one_input, one_output), (other, one, other_input, other_output)):
        inside = instance(outer, inner)
        if inside.node_tree is not None:
            outer.links.new(start.outputs[0], inside.inputs[0])
            outer.links.new(inside.outputs[0], end.inputs[0])
    used = instance(tree, one)
    tree.links.new(noise(tree).outputs["Color"], used.inputs[0])
    into_base_color(tree, used.outputs[0])


def nodes_in_a_circle(tree: Tree) -> None:
    mix, gamma = (tree.nodes.new(f"ShaderNode{name}") for name in ("MixRGB", "Gamma"))
    tree.links.new(noise(tree).outputs["Color"], mix.inputs["Color1"])
    tree.links.new(gamma.outputs[0], mix.inputs["Color2"])
    tree.links.new(mix.outputs[0], gamma.inputs["Color"])
    into_base_color(tree, gamma.outputs[0])


def thousand_nodes(tree: Tree) -> None:
    previous = noise(tree).outputs["Color"]
    for _ in range(1000):
        gamma = tree.nodes.new("ShaderNodeGamma")
        tree.links.new(previous, gamma.inputs["Color"])
        previous = gamma.outputs[0]
    into_base_color(tree, previous)


def nothing_is_linked(tree: Tree) -> None:
    """Nodes of all types, no input of which is linked, joined to one color."""
    previous = noise(tree).outputs["Color"]
    for name in ("Mapping", "TexImage", "TexVoronoi", "Bump", "VectorRotate", "MapRange", "HueSaturation", "Attribute"):
        mix = tree.nodes.new("ShaderNodeMixRGB")
        tree.links.new(tree.nodes.new(f"ShaderNode{name}").outputs[0], mix.inputs["Color1"])
        tree.links.new(previous, mix.inputs["Color2"])
        previous = mix.outputs[0]
    into_base_color(tree, previous)


def sockets_of_unknown_types(tree: Tree) -> None:
    """Inputs and outputs of groups of types that materials do not have."""
    previous = noise(tree).outputs["Color"]
    for socket_type in ("NodeSocketShader", "NodeSocketInt", "NodeSocketBool", "NodeSocketVector"):
        inner, start, end = group(socket_type, socket_type)
        inner.links.new(start.outputs[0], end.inputs[0])
        used = instance(tree, inner)
        tree.links.new(previous, used.inputs[0])
        mix = tree.nodes.new("ShaderNodeMixRGB")
        tree.links.new(used.outputs[0], mix.inputs["Color1"])
        tree.links.new(noise(tree).outputs["Color"], mix.inputs["Color2"])
        previous = mix.outputs[0]
    into_base_color(tree, previous)


def unknown_node(tree: Tree) -> None:
    mix = tree.nodes.new("ShaderNodeMixRGB")
    tree.links.new(tree.nodes.new("ShaderNodeWireframe").outputs[0], mix.inputs["Color1"])
    tree.links.new(noise(tree).outputs["Color"], mix.inputs["Color2"])
    into_base_color(tree, mix.outputs[0])


def input_of(name: str, value: float) -> Callable[[Tree], None]:
    """Sets an input of the surface, whose color is noise."""

    def change(tree: Tree) -> None:
        tree.nodes["Principled BSDF"].inputs[name].default_value = value
        into_base_color(tree, noise(tree).outputs["Color"])

    change.__name__ = f"{name} {value:g}"
    return change


def linked_input_of(name: str, value: float) -> Callable[[Tree], None]:
    """The same by a node whose socket has no limits."""

    def change(tree: Tree) -> None:
        math_node = tree.nodes.new("ShaderNodeMath")
        math_node.operation = "MULTIPLY_ADD"
        tree.links.new(noise(tree).outputs[0], math_node.inputs[0])
        math_node.inputs[1].default_value, math_node.inputs[2].default_value = 0.0, value
        tree.links.new(math_node.outputs[0], tree.nodes["Principled BSDF"].inputs[name])

    change.__name__ = f"linked {name} {value:g}"
    return change


VALUES = -1.0, 0.0, 2.0, 1e8, 3e38, math.nan, math.inf
CHANGES = (
    *(groups_in_a_circle, nodes_in_a_circle, thousand_nodes, nothing_is_linked, sockets_of_unknown_types, unknown_node),
    *(input_of(name, value) for name in ("Alpha", "Roughness", "IOR", "Metallic") for value in VALUES),
    *(linked_input_of(name, value) for name in ("Alpha", "Roughness", "IOR", "Metallic") for value in VALUES),
)


@pytest.fixture
def sphere() -> bpy.types.Object:
    """A sphere in view with a material of nodes."""
    into_blender(*box_over_plane(48, 32))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=8, radius=0.6, location=(0.0, 0.0, 1.0))
    material = bpy.data.materials.new("Odd")
    material.use_nodes = True
    bpy.context.object.data.materials.append(material)
    return bpy.context.object


def draw_open_file(device) -> np.ndarray:
    return draw(device, *out_of_blender(), SMALL_SETTINGS).color


def assert_finite_and_only_the_sphere_changed(
    after: np.ndarray, before: np.ndarray, assert_within, largest: float = 0.15
) -> None:
    """`largest`: fraction of the picture that may change."""
    assert np.isfinite(after).all()
    assert after.min() >= 0.0
    changed = np.abs(after - before)[..., :3].max(-1) > 1e-5
    assert_within(float(changed.mean()), largest)


@pytest.mark.parametrize("change", CHANGES, ids=[change.__name__ for change in CHANGES])
def test_odd_nodes(device, assert_within, sphere, change):
    before = draw_open_file(device)
    change(sphere.active_material.node_tree)
    largest = 0.3 if "Alpha" in change.__name__ else 0.15  # with an alpha of 0 its shadow leaves, too
    assert_finite_and_only_the_sphere_changed(draw_open_file(device), before, assert_within, largest)


@pytest.mark.parametrize("scale", [1e8, 1e30, 0.0, None])
def test_odd_coordinates(device, assert_within, sphere, scale):
    """Texture coordinates that are huge, all the same, or that the mesh does not have."""
    before = draw_open_file(device)
    tree, layers = sphere.active_material.node_tree, sphere.data.uv_layers
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    image = tree.nodes.new("ShaderNodeTexImage")
    image.image = bpy.data.images.new("Image", 4, 4)
    mix, textures = tree.nodes.new("ShaderNodeMixRGB"), (image, noise(tree))
    for texture, name in zip(textures, ("Color1", "Color2"), strict=True):
        tree.links.new(coordinates.outputs["UV"], texture.inputs["Vector"])
        tree.links.new(texture.outputs["Color"], mix.inputs[name])
    bump = tree.nodes.new("ShaderNodeBump")
    tree.links.new(textures[1].outputs[0], bump.inputs["Height"])
    tree.links.new(bump.outputs[0], tree.nodes["Principled BSDF"].inputs["Normal"])
    into_base_color(tree, mix.outputs[0])
    if scale is None:
        layers.remove(layers[0])
    else:
        uvs = np.empty(2 * len(sphere.data.loops), np.float32)
        layers[0].uv.foreach_get("vector", uvs)
        layers[0].uv.foreach_set("vector", np.float32(scale) * uvs)
    sphere.data.update()
    assert_finite_and_only_the_sphere_changed(draw_open_file(device), before, assert_within)


def test_a_thousand_materials(device, sphere):
    """A thousand materials of one structure are one graph; reading and drawing them takes seconds at most."""
    sphere.data.materials.clear()
    bpy.ops.object.mode_set(mode="OBJECT")
    for index in range(1000):
        material = bpy.data.materials.new(f"Noise {index}")
        material.use_nodes = True
        added = noise(material.node_tree)
        added.inputs["Scale"].default_value = index
        into_base_color(material.node_tree, added.outputs["Color"])
        mesh = bpy.data.meshes.new("Triangle")
        mesh.from_pydata([(0.0, 0.0, 0.0), (0.05, 0.0, 0.0), (0.0, 0.05, 0.0)], [], [(0, 1, 2)])
        mesh.materials.append(material)
        bpy.context.scene.collection.objects.link(placed := bpy.data.objects.new("Triangle", mesh))
        placed.location = (index % 40) * 0.05 - 1.0, (index // 40) * 0.05 - 1.0, 1.5
    start = time.perf_counter()
    scene, view = out_of_blender()
    color = draw(device, scene, view, SMALL_SETTINGS).color
    assert time.perf_counter() - start < 20.0
    assert len(scene.graphs) == 1 and len(np.unique(scene.materials.first_constant)) >= 1000
    assert np.isfinite(color).all() and color.min() >= 0.0
