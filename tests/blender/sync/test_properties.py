# SPDX-License-Identifier: GPL-3.0-or-later
"""All of Blender's properties and nodes are handled: each is read, reported, or irrelevant for a listed reason."""

import pickle
from dataclasses import fields
from types import SimpleNamespace

import bpy
import pytest

from ism_addon.blender.sync import camera, scene_reader
from ism_addon.blender.sync.node_graphs.converters import CONVERTERS
from tests.blender.sync.properties import DEPENDENT_INPUTS, INPUTS, IRRELEVANT, READ, REPORTED

NODES = {
    "Principled": "ShaderNodeBsdfPrincipled", "Diffuse": "ShaderNodeBsdfDiffuse", "Emission": "ShaderNodeEmission",
    "Background": "ShaderNodeBackground", "ImageTexture": "ShaderNodeTexImage", "UVMap": "ShaderNodeUVMap",
    "MaterialOutput": "ShaderNodeOutputMaterial", "WorldOutput": "ShaderNodeOutputWorld",
    "LightOutput": "ShaderNodeOutputLight",
}  # fmt: skip
#: Variants of an owner in which further properties have an effect.
VARIANTS = {
    "tall light": "light", "warm light": "light", "point light": "light", "spot light": "light",
    "camera fitted by height": "camera",
    "orthographic camera": "camera", "lamp": "object", "instancer": "object",
}  # fmt: skip
OWNERS = sorted({*READ, *REPORTED, *IRRELEVANT} - {*VARIANTS})


def with_nodes(owner):
    if owner.node_tree is None or not owner.use_nodes:
        owner.use_nodes = True
    return owner


@pytest.fixture
def setup(add, empty_scene) -> SimpleNamespace:
    """A scene with one owner of each list of properties, by its name there."""
    inner = bpy.data.collections.new("Inner")
    empty_scene.collection.children.link(inner)
    thing, instancer = add("Square", collection=inner), add("Instancer")
    child = add("Child")
    child.parent, instancer.instance_type, instancer.show_instancer_for_viewport = instancer, "FACES", False
    for index, name in enumerate(("First", "Second")):
        thing.data.uv_layers.new(name=name).uv.foreach_set("vector", [0.1 + index / 2] * 8)
    material = with_nodes(bpy.data.materials.new("Paint"))
    tree = material.node_tree
    names = NODES["ImageTexture"], NODES["UVMap"]
    image, uv_map = (tree.nodes.new(name) for name in names)
    image.image, uv_map.uv_map = bpy.data.images.new("Picture", 2, 2), "First"
    principled = tree.nodes["Principled BSDF"]
    tree.links.new(uv_map.outputs[0], image.inputs["Vector"])
    tree.links.new(image.outputs["Color"], principled.inputs["Base Color"])
    thing.data.materials.append(material)
    light_object = add("Lamp", with_nodes(bpy.data.lights.new("Lamp", "AREA")))
    light_object.data.node_tree.nodes["Emission"].inputs["Strength"].default_value = 2.0
    camera_object = empty_scene.camera = add("Camera", bpy.data.cameras.new("Camera"))
    world = empty_scene.world = with_nodes(bpy.data.worlds.new("World"))
    view_layer = bpy.context.view_layer
    view_layer.use_freestyle = view_layer.use_motion_blur = False
    empty_scene.render.use_freestyle = empty_scene.render.use_motion_blur = True
    owners = {
        "light": light_object.data, "material": material, "camera": camera_object.data, "world": world, "object": thing,
        "view_layer": view_layer, "layer_collection": view_layer.layer_collection.children["Inner"],
        "lamp": light_object,
        "instancer": instancer, "ImageTexture": image, "UVMap": uv_map, "Principled": principled,
        "Diffuse": tree.nodes.new(NODES["Diffuse"]), "MaterialOutput": tree.nodes["Material Output"],
        "Emission": light_object.data.node_tree.nodes["Emission"], "Background": world.node_tree.nodes["Background"],
        "WorldOutput": world.node_tree.nodes["World Output"],
        "LightOutput": light_object.data.node_tree.nodes["Light Output"],
    }  # fmt: skip
    return SimpleNamespace(scene=empty_scene, owners=owners, material=material)


def find_owner(setup, name):
    """The owner of that name; None if this release of Blender has none."""
    first, _, member = name.partition(".")
    owner = setup.owners[VARIANTS.get(first, first)] if first not in setup.owners else setup.owners[first]
    if name == "tall light":
        owner.shape = "RECTANGLE"
    if name in ("point light", "spot light"):
        owner.type = name.partition(" ")[0].upper()
        return bpy.data.lights[owner.name]  # with the properties of its new type
    if name == "warm light" and hasattr(owner, "use_temperature"):
        owner.use_temperature = True
    if name == "camera fitted by height":
        owner.sensor_fit = "VERTICAL"
    if name == "orthographic camera":
        owner.type = "ORTHO"
    return getattr(owner, member, None) if member else owner


def own_properties(owner) -> set[str]:
    """Names of the owner's properties, without those that all IDs or all nodes have."""
    general = {"name", "rna_type"}
    for base in (bpy.types.ID, bpy.types.ShaderNode):
        if isinstance(owner, base):
            general |= {*base.bl_rna.properties.keys()}
    return {*owner.bl_rna.properties.keys()} - general


def read_all() -> tuple[bytes, tuple[str, ...]]:
    """Everything that a picture depends on, and the warnings."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    scene = scene_reader.scene(depsgraph)
    tables = *scene.graphs, *scene.meshes, scene.instances, scene.materials, *scene.images, scene.lights, scene.world
    try:
        tables = *tables, camera.final_view(depsgraph)
    except camera.CameraError as refused:
        return b"", (str(refused),)
    return pickle.dumps([[getattr(table, field.name) for field in fields(table)] for table in tables]), scene.warnings


@pytest.mark.parametrize("name", OWNERS)
def test_every_property_is_read_reported_or_irrelevant(setup, name):
    owner = find_owner(setup, name)
    if owner is None:
        return  # not in this release of Blender
    variants = [name, *(variant for variant, of in VARIANTS.items() if of == name)]
    known = {each for variant in variants for lists in (READ, REPORTED) for each in lists.get(variant, {})}
    known |= {each for names in IRRELEVANT.get(name, {}).values() for each in names.split()}
    assert own_properties(owner) - known == set(), "not listed as read, reported or irrelevant"


@pytest.mark.parametrize(("name", "attribute"), [(name, each) for name, of in READ.items() for each in of])
def test_what_is_read_changes_the_scene_or_the_view(setup, name, attribute):
    owner, value = find_owner(setup, name), READ[name][attribute]
    if not hasattr(owner, attribute) or (attribute == "use_nodes" and bpy.app.version >= (5, 2)):
        return  # not in this release of Blender: since 5.2, all lights have nodes
    before, _ = read_all()
    if value == "other material":
        value = with_nodes(bpy.data.materials.new("Other"))
    elif value == "other world":
        value = with_nodes(bpy.data.worlds.new("Other"))
        value.node_tree.nodes["Background"].inputs["Color"].default_value = (0, 1, 0, 1)
    elif value == "toggle":
        value = not getattr(owner, attribute)
    if attribute == "target":  # then Cycles uses the other output
        other = setup.material.node_tree.nodes.new(NODES["MaterialOutput"])
        other.is_active_output, owner.is_active_output = False, True
        before, _ = read_all()
    setattr(owner, attribute, value)
    owner.id_data.update_tag()  # Cycles' own properties need it: only its panels tag the update
    assert read_all()[0] != before


@pytest.mark.parametrize(("name", "attribute"), [(name, each) for name, of in REPORTED.items() for each in of])
def test_reported_properties_add_a_warning(setup, name, attribute):
    owner = find_owner(setup, name)
    if not hasattr(owner, attribute):
        return  # not in this release of Blender
    _, before = read_all()
    setattr(owner, attribute, REPORTED[name][attribute])
    owner.id_data.update_tag()
    assert len(read_all()[1]) == len(before) + 1


@pytest.mark.parametrize("name", INPUTS)
def test_every_input_of_a_drawn_node_is_read_or_reported(setup, name):
    node, (read, reported) = find_owner(setup, name), INPUTS[name]
    known = {*read.split("|"), *reported.split("|"), *DEPENDENT_INPUTS.split("|")}
    assert {socket.name for socket in node.inputs} - known == set()
    for socket in node.inputs:
        if socket.name not in reported.split("|"):
            continue
        tree = node.id_data
        if name == "Diffuse":
            tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
        node_types = {"Volume": "ShaderNodeVolumeScatter", "Vector": "ShaderNodeParticleInfo"}
        _, before = read_all()
        source = tree.nodes.new(node_types.get(socket.name, "ShaderNodeBump"))
        link = tree.links.new(source.outputs[0], socket)
        assert len(read_all()[1]) == len(before) + 1, socket.name
        if name != "ImageTexture":
            tree.links.remove(link)


def shader_node_types() -> list[str]:
    found = (getattr(bpy.types, name) for name in dir(bpy.types) if name.startswith("ShaderNode"))
    return sorted(cls.__name__ for cls in found if isinstance(cls, type) and issubclass(cls, bpy.types.ShaderNode))


def test_every_node_that_can_be_linked_to_a_surface_is_drawn_or_reported(setup):
    tree, surface = setup.material.node_tree, setup.owners["MaterialOutput"].inputs["Surface"]
    color, plain = setup.owners["Principled"].inputs["Base Color"], setup.owners["Principled"].outputs[0]
    tried = []
    for node_type in shader_node_types():
        try:
            node = tree.nodes.new(node_type)
        except RuntimeError:  # a base class, or of another type of tree
            continue
        for output in node.outputs:
            target = surface if output.type == "SHADER" else color
            tree.links.new(plain, surface)
            tree.links.new(output, target)
            if not output.enabled or output.is_unavailable or not any(link.is_valid for link in target.links):
                continue
            scene = scene_reader.scene(bpy.context.evaluated_depsgraph_get())
            is_drawn = bool(scene.graphs) or node_type in CONVERTERS
            assert is_drawn or any(node.bl_label in warning for warning in scene.warnings), (
                f"{node_type}, {output.name}"
            )
            tried.append(node_type)
        tree.nodes.remove(node)
    assert len({*tried}) > 80


def test_every_type_of_light_is_read(add, read_scene):
    light_types = bpy.types.Light.bl_rna.properties["type"].enum_items.keys()
    for light_type in light_types:
        add(light_type, bpy.data.lights.new(light_type, light_type)).data.energy = 1.0
    assert len(read_scene().lights.shape) == len(light_types) >= 4
