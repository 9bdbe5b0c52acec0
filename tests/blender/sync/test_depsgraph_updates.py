# SPDX-License-Identifier: GPL-3.0-or-later
"""A Reader that receives all updates has the same scene as a new Reader, and reads only what has changed."""

import random
from collections.abc import Callable
from dataclasses import fields
from types import SimpleNamespace

import bmesh
import bpy
import numpy as np
import pytest

from ism_addon.blender.sync.geometry import instances
from ism_addon.blender.sync.scene_reader import Reader
from ism_addon.scene import Scene

TRIANGLE = ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])


@pytest.fixture
def setup(empty_scene, add) -> SimpleNamespace:
    """A scene and its data: shared meshes, a child, an instanced collection, modifiers, a light, an image."""
    red, blue = (bpy.data.materials.new(name) for name in ("red", "blue"))
    for material in (red, blue):
        material.use_nodes = True
    first, twin, child, modified = add("first"), add("twin"), add("child", TRIANGLE), add("modified", TRIANGLE)
    twin.data = first.data
    child.parent = first
    first.data.materials.append(red)
    child.data.materials.append(blue)
    modified.modifiers.new("array", "ARRAY")
    inner = bpy.data.collections.new("inner")
    leaf = add("leaf", TRIANGLE, inner)
    holder = add("holder", None)
    holder.instance_type, holder.instance_collection = "COLLECTION", inner
    row = add("row", ([], []))
    row.modifiers.new("row", "NODES").node_group = row_nodes(leaf)
    light = add("lamp", bpy.data.lights.new("lamp", "AREA"))
    image = bpy.data.images.new("image", 4, 4)
    texture = blue.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    blue.node_tree.links.new(texture.outputs["Color"], blue.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    bpy.context.view_layer.objects.active = first
    empty_scene.world = bpy.data.worlds.new("world")
    empty_scene.world.use_nodes = True
    return SimpleNamespace(
        scene=empty_scene, add=add, red=red, blue=blue, image=image, inner=inner,
        first=first, twin=twin, child=child, modified=modified, leaf=leaf, holder=holder, row=row, light=light,
    )  # fmt: skip


def row_nodes(thing: bpy.types.Object) -> bpy.types.NodeTree:
    """Geometry nodes that instance an object along a line; a property of the modifier is the count."""
    nodes = bpy.data.node_groups.new("row", "GeometryNodeTree")
    nodes.interface.new_socket("Count", in_out="INPUT", socket_type="NodeSocketInt").default_value = 2
    nodes.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    types = "NodeGroupInput", "GeometryNodeMeshLine", "GeometryNodeObjectInfo", "GeometryNodeInstanceOnPoints"
    start, line, info, instances, end = (nodes.nodes.new(node_type) for node_type in (*types, "NodeGroupOutput"))
    info.inputs["Object"].default_value, info.inputs["As Instance"].default_value = thing, True
    nodes.links.new(start.outputs["Count"], line.inputs["Count"])
    nodes.links.new(line.outputs["Mesh"], instances.inputs["Points"])
    nodes.links.new(info.outputs["Geometry"], instances.inputs["Instance"])
    nodes.links.new(instances.outputs["Instances"], end.inputs["Geometry"])
    return nodes


def base_color(material: bpy.types.Material) -> bpy.types.NodeSocket:
    return material.node_tree.nodes["Principled BSDF"].inputs["Base Color"]


def move_vertex(setup: SimpleNamespace) -> None:
    bpy.ops.object.mode_set(mode="OBJECT")
    setup.first.data.vertices[0].co.z += 1.0
    setup.first.data.update()


def paint(setup: SimpleNamespace) -> None:
    setup.image.pixels[0] = 0.7 - setup.image.pixels[0]
    setup.image.update()
    setup.image.update_tag()


def duplicate(setup: SimpleNamespace) -> None:
    copy = setup.twin.copy()
    copy.location.x += 3.0
    setup.scene.collection.objects.link(copy)


def lengthen_row(setup: SimpleNamespace) -> None:
    for modifier in setup.row.modifiers:
        count = modifier.node_group.interface.items_tree["Count"].identifier
        modifier[count] = (modifier[count] + 2) % 5
        setup.row.update_tag()


def recolor(setup: SimpleNamespace) -> None:
    base_color(setup.red).default_value = (random.random(), 0.2, 0.3, 1.0)


def move_vertex_in_edit_mode(setup: SimpleNamespace) -> None:
    bpy.context.view_layer.objects.active = setup.first
    bpy.ops.object.mode_set(mode="EDIT")
    edited = bmesh.from_edit_mesh(setup.first.data)
    next(iter(edited.verts)).co.z += 1.0
    bmesh.update_edit_mesh(setup.first.data)


def edit_in_edit_mode(setup: SimpleNamespace) -> None:
    bpy.context.view_layer.objects.active = setup.first
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")


def toggle(owner: str, attribute: str) -> Callable[[SimpleNamespace], None]:
    """An edit that inverts a boolean property."""

    def edit(setup: SimpleNamespace) -> None:
        thing = getattr(setup, owner)
        setattr(thing, attribute, not getattr(thing, attribute))

    return edit


def move(owner: str) -> Callable[[SimpleNamespace], None]:
    """An edit that moves an object."""

    def edit(setup: SimpleNamespace) -> None:
        getattr(setup, owner).location.x += 0.5

    return edit


EDITS: dict[str, Callable[[SimpleNamespace], None]] = {
    "move a parent": move("first"),
    "move a child": move("child"),
    "move what a collection instances": move("leaf"),
    "move a collection's instance": move("holder"),
    "move a light": move("light"),
    "dim a light": lambda setup: setattr(setup.light.data, "energy", setup.light.data.energy * 0.9),
    "switch a light's shadow": lambda setup: setattr(setup.light.data, "use_shadow", not setup.light.data.use_shadow),
    "make a light a spot or an area": lambda setup: setattr(
        setup.light.data, "type", "SPOT" if setup.light.data.type == "AREA" else "AREA"
    ),
    "hide and show": toggle("twin", "hide_viewport"),
    "hide and show by the eye": lambda setup: setup.twin.hide_set(not setup.twin.hide_get()),
    "hide what a collection instances": toggle("leaf", "hide_viewport"),
    "no shadow": toggle("child", "visible_shadow"),
    "unseen": toggle("child", "visible_camera"),
    "a holdout": toggle("twin", "is_holdout"),
    "recolour": recolor,
    "darken the world": lambda setup: setattr(
        setup.scene.world.node_tree.nodes["Background"].inputs["Strength"], "default_value", random.random()
    ),
    "swap a material": lambda setup: setattr(
        setup.first.material_slots[0], "material", random.choice((setup.red, setup.blue, None))
    ),
    "move a vertex": move_vertex,
    "move a vertex in edit mode": move_vertex_in_edit_mode,
    "leave edit mode": lambda setup: bpy.ops.object.mode_set(mode="OBJECT"),
    "subdivide in edit mode": edit_in_edit_mode,
    "more of an array": lambda setup: setattr(
        setup.modified.modifiers["array"], "count", 1 + setup.modified.modifiers["array"].count % 4
    ),
    "more or less of a row": lengthen_row,
    "move a row": move("row"),
    "instance a collection or not": lambda setup: setattr(
        setup.holder, "instance_type", "NONE" if setup.holder.instance_type == "COLLECTION" else "COLLECTION"
    ),
    "no row": lambda setup: setup.row.modifiers.clear(),
    "paint an image": paint,
    "duplicate": duplicate,
    "rename": lambda setup: setattr(setup.first, "name", "another"),
    "flatten to nothing": lambda setup: setattr(setup.twin, "scale", (1, 1, 1 - round(setup.twin.scale.z))),
    "another frame": lambda setup: setup.scene.frame_set(setup.scene.frame_current + 1),
    "override all materials": lambda setup: setattr(
        bpy.context.view_layer,
        "material_override",
        None if bpy.context.view_layer.material_override else setup.red,
    ),
    "particles": lambda setup: setup.modified.modifiers.new("hair", "PARTICLE_SYSTEM"),
}


def canonical(scene: Scene) -> dict[str, object]:
    """The contents of a Scene, independent of the order of its tables."""
    rows, arrays = [], [getattr(scene.instances, member.name) for member in fields(scene.instances)[1:]]
    for instance, mesh in enumerate(scene.instances.mesh):
        shape = scene.meshes[mesh]
        colors = scene.materials.base_color[shape.materials]
        images = [scene.images[image].texels.tobytes() if image >= 0 else b"" for image in scene.materials.image]
        rows.append(
            (
                *(array[instance].tobytes() for array in arrays if len(array)),
                *(getattr(shape, name).tobytes() for name in ("positions", "triangles", "normals", "uvs")),
                colors.tobytes(),
                tuple(images[material] for material in shape.materials),
            )
        )
    lights = [getattr(scene.lights, member.name).tolist() for member in fields(scene.lights)]
    return {
        "instances": sorted(rows),
        "lights": lights,
        "world": scene.world.radiance.tolist(),
        "warnings": sorted(scene.warnings),
    }


@pytest.mark.parametrize("name", EDITS)
def test_after_repeated_edits_the_scene_equals_that_of_a_new_reader(setup, latest_scene, name):
    for _ in range(3):
        EDITS[name](setup)
        scene = latest_scene()
        assert canonical(scene) == canonical(Reader().read(bpy.context.evaluated_depsgraph_get()))


@pytest.mark.parametrize("seed", range(4))
def test_after_random_edits_the_scene_equals_that_of_a_new_reader(setup, latest_scene, seed):
    rng = random.Random(seed)
    for _ in range(30):
        names = rng.choices(list(EDITS), k=rng.randint(1, 3))
        for name in names:
            EDITS[name](setup)
        scene = latest_scene()
        assert canonical(scene) == canonical(Reader().read(bpy.context.evaluated_depsgraph_get())), names


@pytest.mark.parametrize(
    ("name", "new"),
    {
        "move a child": {"instances"},
        "move a collection's instance": {"instances"},
        "move a light": {"lights"},
        "dim a light": {"lights"},
        "recolour": {"materials"},
        "darken the world": {"world"},
        "rename": set(),
        "another frame": set(),
        "no shadow": {"instances"},
    }.items(),
)
def test_only_changed_tables_are_new_objects(setup, latest_scene, name, new, monkeypatch):
    before = latest_scene()
    monkeypatch.setattr(instances, "_raw", None)  # no mesh is read
    EDITS[name](setup)
    after = latest_scene()
    tables = ("meshes", "instances", "materials", "images", "lights", "world")
    assert {table for table in tables if getattr(before, table) != getattr(after, table)} == new
    assert (after is before) == (not new)


def test_only_the_edited_mesh_is_a_new_object(setup, latest_scene):
    before = latest_scene()
    EDITS["move a vertex"](setup)
    after = latest_scene()
    assert len(set(before.meshes) - set(after.meshes)) == 1
    assert after.instances is before.instances


def test_a_mesh_that_is_read_again_unchanged_stays_the_same_object(setup, latest_scene):
    before = latest_scene()
    setup.first.data.update()
    setup.first.update_tag(refresh={"DATA"})
    assert latest_scene() is before


def test_hidden_objects_are_left_out_until_they_are_shown_again(setup):
    reader, depsgraph = Reader(), bpy.context.evaluated_depsgraph_get()
    everything = reader.read(depsgraph)
    without_holder = reader.read(depsgraph, is_shown=lambda thing: thing.name != "holder", all_instances=True)
    assert len(without_holder.instances.mesh) == len(everything.instances.mesh) - 1
    assert canonical(reader.read(depsgraph, all_instances=True)) == canonical(everything)
    assert np.isfinite(everything.extent)
