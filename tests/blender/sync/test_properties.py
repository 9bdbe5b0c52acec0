# SPDX-License-Identifier: GPL-3.0-or-later
"""No property of Blender's and no node is forgotten: each is read, or said, or listed as irrelevant with a reason."""

import pickle
from dataclasses import fields
from types import SimpleNamespace

import bpy
import pytest

from ism_addon.blender.sync import camera, scene_reader
from tests.blender.sync.properties import INPUTS, INPUTS_OF_OTHERS, IRRELEVANT, READ, SAID

NODES = {
    "Principled": "ShaderNodeBsdfPrincipled", "Diffuse": "ShaderNodeBsdfDiffuse", "Emission": "ShaderNodeEmission",
    "Background": "ShaderNodeBackground", "ImageTexture": "ShaderNodeTexImage", "UVMap": "ShaderNodeUVMap",
    "MaterialOutput": "ShaderNodeOutputMaterial", "WorldOutput": "ShaderNodeOutputWorld",
    "LightOutput": "ShaderNodeOutputLight",
}  # fmt: skip
#: Variants of an owner that let some of its properties count.
VARIANTS = {
    "tall light": "light", "warm light": "light", "camera fitted by height": "camera",
    "orthographic camera": "camera", "lamp": "object", "instancer": "object",
}  # fmt: skip
OWNERS = sorted({*READ, *SAID, *IRRELEVANT} - {*VARIANTS})


def with_nodes(owner):
    if owner.node_tree is None or not owner.use_nodes:
        owner.use_nodes = True
    return owner


@pytest.fixture
def stage(add, empty_scene) -> SimpleNamespace:
    """One of everything that has properties, by its name in the lists."""
    inner = bpy.data.collections.new("Inner")
    empty_scene.collection.children.link(inner)
    thing, instancer = add("Square", collection=inner), add("Instancer")
    child = add("Child")
    child.parent, instancer.instance_type, instancer.show_instancer_for_viewport = instancer, "FACES", False
    for number, name in enumerate(("First", "Second")):
        thing.data.uv_layers.new(name=name).uv.foreach_set("vector", [0.1 + number / 2] * 8)
    material = with_nodes(bpy.data.materials.new("Paint"))
    tree = material.node_tree
    names = NODES["ImageTexture"], NODES["UVMap"]
    image, uv_map = (tree.nodes.new(name) for name in names)
    image.image, uv_map.uv_map = bpy.data.images.new("Picture", 2, 2), "First"
    principled = tree.nodes["Principled BSDF"]
    tree.links.new(uv_map.outputs[0], image.inputs["Vector"])
    tree.links.new(image.outputs["Color"], principled.inputs["Base Color"])
    thing.data.materials.append(material)
    lamp = add("Lamp", with_nodes(bpy.data.lights.new("Lamp", "AREA")))
    lamp.data.node_tree.nodes["Emission"].inputs["Strength"].default_value = 2.0
    seen_by = empty_scene.camera = add("Camera", bpy.data.cameras.new("Camera"))
    world = empty_scene.world = with_nodes(bpy.data.worlds.new("World"))
    view_layer = bpy.context.view_layer
    view_layer.use_freestyle = view_layer.use_motion_blur = False
    empty_scene.render.use_freestyle = empty_scene.render.use_motion_blur = True
    owners = {
        "light": lamp.data, "material": material, "camera": seen_by.data, "world": world, "object": thing,
        "view_layer": view_layer, "layer_collection": view_layer.layer_collection.children["Inner"], "lamp": lamp,
        "instancer": instancer, "ImageTexture": image, "UVMap": uv_map, "Principled": principled,
        "Diffuse": tree.nodes.new(NODES["Diffuse"]), "MaterialOutput": tree.nodes["Material Output"],
        "Emission": lamp.data.node_tree.nodes["Emission"], "Background": world.node_tree.nodes["Background"],
        "WorldOutput": world.node_tree.nodes["World Output"],
        "LightOutput": lamp.data.node_tree.nodes["Light Output"],
    }  # fmt: skip
    return SimpleNamespace(scene=empty_scene, owners=owners, material=material)


def owner_of(stage, name):
    """None where this Blender has none."""
    first, _, part = name.partition(".")
    owner = stage.owners[VARIANTS.get(first, first)] if first not in stage.owners else stage.owners[first]
    if name == "tall light":
        owner.shape = "RECTANGLE"
    if name == "warm light" and hasattr(owner, "use_temperature"):
        owner.use_temperature = True
    if name == "camera fitted by height":
        owner.sensor_fit = "VERTICAL"
    if name == "orthographic camera":
        owner.type = "ORTHO"
    return getattr(owner, part, None) if part else owner


def properties_of(owner) -> set[str]:
    """Its own, without those that all IDs or all nodes have."""
    general = {"name", "rna_type"}
    for base in (bpy.types.ID, bpy.types.ShaderNode):
        if isinstance(owner, base):
            general |= {*base.bl_rna.properties.keys()}
    return {*owner.bl_rna.properties.keys()} - general


def drawn() -> tuple[bytes, tuple[str, ...]]:
    """All that a picture is made of, and what was said of it."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    scene = scene_reader.scene(depsgraph)
    parts = *scene.meshes, scene.instances, scene.materials, *scene.images, scene.lights, scene.world
    try:
        parts = *parts, camera.final_view(depsgraph)
    except camera.CameraError as refused:
        return b"", (str(refused),)
    return pickle.dumps([[getattr(part, member.name) for member in fields(part)] for part in parts]), scene.warnings


@pytest.mark.parametrize("name", OWNERS)
def test_every_property_is_read_said_or_irrelevant(stage, name):
    owner = owner_of(stage, name)
    if owner is None:
        return  # of another Blender
    variants = [name, *(variant for variant, of in VARIANTS.items() if of == name)]
    known = {each for variant in variants for lists in (READ, SAID) for each in lists.get(variant, {})}
    known |= {each for names in IRRELEVANT.get(name, {}).values() for each in names.split()}
    assert properties_of(owner) - known == set(), "neither read, nor said, nor listed with a reason"


@pytest.mark.parametrize(("name", "attribute"), [(name, each) for name, of in READ.items() for each in of])
def test_what_is_read_changes_what_is_drawn(stage, name, attribute):
    owner, value = owner_of(stage, name), READ[name][attribute]
    if not hasattr(owner, attribute) or (attribute == "use_nodes" and bpy.app.version >= (5, 2)):
        return  # of another Blender: since 5.2, all lights have nodes
    before, _ = drawn()
    if value == "other material":
        value = with_nodes(bpy.data.materials.new("Other"))
    elif value == "other world":
        value = with_nodes(bpy.data.worlds.new("Other"))
        value.node_tree.nodes["Background"].inputs["Color"].default_value = (0, 1, 0, 1)
    elif value == "toggle":
        value = not getattr(owner, attribute)
    if attribute == "target":  # another output is the one that Cycles takes then
        other = stage.material.node_tree.nodes.new(NODES["MaterialOutput"])
        other.is_active_output, owner.is_active_output = False, True
        before, _ = drawn()
    setattr(owner, attribute, value)
    owner.id_data.update_tag()  # which of Cycles' own properties only its panels do
    assert drawn()[0] != before


@pytest.mark.parametrize(("name", "attribute"), [(name, each) for name, of in SAID.items() for each in of])
def test_what_is_said_is_said(stage, name, attribute):
    owner = owner_of(stage, name)
    if not hasattr(owner, attribute):
        return  # of another Blender
    _, before = drawn()
    setattr(owner, attribute, SAID[name][attribute])
    owner.id_data.update_tag()
    assert len(drawn()[1]) == len(before) + 1


@pytest.mark.parametrize("name", INPUTS)
def test_every_input_of_a_node_that_is_drawn_is_read_or_said(stage, name):
    node, (read, said) = owner_of(stage, name), INPUTS[name]
    known = {*read.split("|"), *said.split("|"), *INPUTS_OF_OTHERS.split("|")}
    assert {socket.name for socket in node.inputs} - known == set()
    for socket in node.inputs:
        if socket.name not in said.split("|"):
            continue
        tree = node.id_data
        if name == "Diffuse":
            tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
        kind = {"Volume": "ShaderNodeVolumeScatter", "Vector": "ShaderNodeMapping"}.get(socket.name, "ShaderNodeBump")
        _, before = drawn()
        link = tree.links.new(tree.nodes.new(kind).outputs[0], socket)
        assert len(drawn()[1]) == len(before) + 1, socket.name
        if name != "ImageTexture":
            tree.links.remove(link)


def shader_nodes() -> list[str]:
    found = (getattr(bpy.types, name) for name in dir(bpy.types) if name.startswith("ShaderNode"))
    return sorted(kind.__name__ for kind in found if isinstance(kind, type) and issubclass(kind, bpy.types.ShaderNode))


def test_every_node_that_may_feed_a_surface_is_drawn_or_said(stage):
    tree, surface = stage.material.node_tree, stage.owners["MaterialOutput"].inputs["Surface"]
    color, plain = stage.owners["Principled"].inputs["Base Color"], stage.owners["Principled"].outputs[0]
    tried = []
    for kind in shader_nodes():
        try:
            node = tree.nodes.new(kind)
        except RuntimeError:  # the base of others, or of other trees
            continue
        for output in node.outputs:
            target = surface if output.type == "SHADER" else color
            tree.links.new(plain, surface)
            tree.links.new(output, target)
            if not output.enabled or output.is_unavailable or not any(link.is_valid for link in target.links):
                continue
            drawn_by_us = kind in (*NODES.values(), "ShaderNodeRGB")
            assert drawn_by_us or any(node.bl_label in said for said in drawn()[1]), f"{kind}, {output.name}"
            tried.append(kind)
        tree.nodes.remove(node)
    assert len({*tried}) > 80


def test_every_other_kind_of_light_is_said(add, extracted):
    kinds = bpy.types.Light.bl_rna.properties["type"].enum_items.keys()
    for kind in {*kinds} - {"AREA"}:
        add(kind, bpy.data.lights.new(kind, kind))
    assert len(extracted().warnings) == len(kinds) - 1 >= 3
