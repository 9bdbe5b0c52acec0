# SPDX-License-Identifier: GPL-3.0-or-later
"""A Reader that follows a scene's edits has, after each, what a new one reads; and it reads no more than it must."""

import random
from collections.abc import Callable, Iterator
from dataclasses import fields
from types import SimpleNamespace

import bmesh
import bpy
import numpy as np
import pytest
from bpy.app.handlers import depsgraph_update_post, frame_change_post

from ism_addon.blender.sync.geometry import instances
from ism_addon.blender.sync.scene_reader import Reader
from ism_addon.scene import Scene

TRIANGLE = ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])


@pytest.fixture
def stage(empty_scene, add) -> SimpleNamespace:
    """Some of everything: shared meshes, a child, an instanced collection, a modifier, a light, an image."""
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
    row.modifiers.new("row", "NODES").node_group = row_of(leaf)
    lamp = add("lamp", bpy.data.lights.new("lamp", "AREA"))
    image = bpy.data.images.new("image", 4, 4)
    texture = blue.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    blue.node_tree.links.new(texture.outputs["Color"], blue.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    bpy.context.view_layer.objects.active = first
    empty_scene.world = bpy.data.worlds.new("world")
    empty_scene.world.use_nodes = True
    return SimpleNamespace(
        scene=empty_scene, add=add, red=red, blue=blue, image=image, inner=inner,
        first=first, twin=twin, child=child, modified=modified, leaf=leaf, holder=holder, row=row, lamp=lamp,
    )  # fmt: skip


def row_of(thing: bpy.types.Object) -> bpy.types.NodeTree:
    """Geometry nodes that instance an object along a line, as often as the modifier says."""
    nodes = bpy.data.node_groups.new("row", "GeometryNodeTree")
    nodes.interface.new_socket("Count", in_out="INPUT", socket_type="NodeSocketInt").default_value = 2
    nodes.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    kinds = "NodeGroupInput", "GeometryNodeMeshLine", "GeometryNodeObjectInfo", "GeometryNodeInstanceOnPoints"
    given, line, info, instances, made = (nodes.nodes.new(kind) for kind in (*kinds, "NodeGroupOutput"))
    info.inputs["Object"].default_value, info.inputs["As Instance"].default_value = thing, True
    nodes.links.new(given.outputs["Count"], line.inputs["Count"])
    nodes.links.new(line.outputs["Mesh"], instances.inputs["Points"])
    nodes.links.new(info.outputs["Geometry"], instances.inputs["Instance"])
    nodes.links.new(instances.outputs["Instances"], made.inputs["Geometry"])
    return nodes


@pytest.fixture
def followed(stage) -> Iterator[Callable[[], Scene]]:
    """followed(): the Scene of a Reader that is told of every update, and of nothing else."""
    reader, read = Reader(), []

    def follow(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
        read[:] = [reader.read(depsgraph)]

    handlers = depsgraph_update_post, frame_change_post
    for handler in handlers:
        handler.append(follow)
    bpy.context.view_layer.update()
    read[:] = [reader.read(bpy.context.evaluated_depsgraph_get())]

    def latest() -> Scene:
        bpy.context.view_layer.update()
        return read[0]

    yield latest
    for handler in handlers:
        handler.remove(follow)


def base_color(material: bpy.types.Material) -> bpy.types.NodeSocket:
    return material.node_tree.nodes["Principled BSDF"].inputs["Base Color"]


def move_vertex(stage: SimpleNamespace) -> None:
    bpy.ops.object.mode_set(mode="OBJECT")
    stage.first.data.vertices[0].co.z += 1.0
    stage.first.data.update()


def paint(stage: SimpleNamespace) -> None:
    stage.image.pixels[0] = 0.7 - stage.image.pixels[0]
    stage.image.update()
    stage.image.update_tag()


def duplicate(stage: SimpleNamespace) -> None:
    copy = stage.twin.copy()
    copy.location.x += 3.0
    stage.scene.collection.objects.link(copy)


def lengthen_row(stage: SimpleNamespace) -> None:
    for modifier in stage.row.modifiers:
        count = modifier.node_group.interface.items_tree["Count"].identifier
        modifier[count] = (modifier[count] + 2) % 5
        stage.row.update_tag()


def recolor(stage: SimpleNamespace) -> None:
    base_color(stage.red).default_value = (random.random(), 0.2, 0.3, 1.0)


def move_vertex_in_edit_mode(stage: SimpleNamespace) -> None:
    bpy.context.view_layer.objects.active = stage.first
    bpy.ops.object.mode_set(mode="EDIT")
    edited = bmesh.from_edit_mesh(stage.first.data)
    next(iter(edited.verts)).co.z += 1.0
    bmesh.update_edit_mesh(stage.first.data)


def edit_in_edit_mode(stage: SimpleNamespace) -> None:
    bpy.context.view_layer.objects.active = stage.first
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.subdivide()
    bpy.ops.object.mode_set(mode="OBJECT")


def flip(owner: str, attribute: str) -> Callable[[SimpleNamespace], None]:
    """An edit that turns a switch over."""

    def edit(stage: SimpleNamespace) -> None:
        thing = getattr(stage, owner)
        setattr(thing, attribute, not getattr(thing, attribute))

    return edit


def shift(owner: str) -> Callable[[SimpleNamespace], None]:
    """An edit that moves an object."""

    def edit(stage: SimpleNamespace) -> None:
        getattr(stage, owner).location.x += 0.5

    return edit


EDITS: dict[str, Callable[[SimpleNamespace], None]] = {
    "move a parent": shift("first"),
    "move a child": shift("child"),
    "move what a collection instances": shift("leaf"),
    "move a collection's instance": shift("holder"),
    "move a light": shift("lamp"),
    "dim a light": lambda stage: setattr(stage.lamp.data, "energy", stage.lamp.data.energy * 0.9),
    "switch a light's shadow": lambda stage: setattr(stage.lamp.data, "use_shadow", not stage.lamp.data.use_shadow),
    "make a light a spot or an area": lambda stage: setattr(
        stage.lamp.data, "type", "SPOT" if stage.lamp.data.type == "AREA" else "AREA"
    ),
    "hide and show": flip("twin", "hide_viewport"),
    "hide and show by the eye": lambda stage: stage.twin.hide_set(not stage.twin.hide_get()),
    "hide what a collection instances": flip("leaf", "hide_viewport"),
    "no shadow": flip("child", "visible_shadow"),
    "unseen": flip("child", "visible_camera"),
    "a holdout": flip("twin", "is_holdout"),
    "recolour": recolor,
    "darken the world": lambda stage: setattr(
        stage.scene.world.node_tree.nodes["Background"].inputs["Strength"], "default_value", random.random()
    ),
    "swap a material": lambda stage: setattr(
        stage.first.material_slots[0], "material", random.choice((stage.red, stage.blue, None))
    ),
    "move a vertex": move_vertex,
    "move a vertex in edit mode": move_vertex_in_edit_mode,
    "leave edit mode": lambda stage: bpy.ops.object.mode_set(mode="OBJECT"),
    "subdivide in edit mode": edit_in_edit_mode,
    "more of an array": lambda stage: setattr(
        stage.modified.modifiers["array"], "count", 1 + stage.modified.modifiers["array"].count % 4
    ),
    "more or less of a row": lengthen_row,
    "move a row": shift("row"),
    "instance a collection or not": lambda stage: setattr(
        stage.holder, "instance_type", "NONE" if stage.holder.instance_type == "COLLECTION" else "COLLECTION"
    ),
    "no row": lambda stage: stage.row.modifiers.clear(),
    "paint an image": paint,
    "duplicate": duplicate,
    "rename": lambda stage: setattr(stage.first, "name", "another"),
    "flatten to nothing": lambda stage: setattr(stage.twin, "scale", (1, 1, 1 - round(stage.twin.scale.z))),
    "another frame": lambda stage: stage.scene.frame_set(stage.scene.frame_current + 1),
    "override all materials": lambda stage: setattr(
        bpy.context.view_layer,
        "material_override",
        None if bpy.context.view_layer.material_override else stage.red,
    ),
    "particles": lambda stage: stage.modified.modifiers.new("hair", "PARTICLE_SYSTEM"),
}


def flat(scene: Scene) -> dict[str, object]:
    """What a Scene says, whatever the order of its tables is."""
    rows = []
    for instance, mesh in enumerate(scene.instances.mesh):
        shape = scene.meshes[mesh]
        colors = scene.materials.base_color[shape.materials]
        images = [scene.images[image].texels.tobytes() if image >= 0 else b"" for image in scene.materials.image]
        rows.append(
            (
                *(getattr(scene.instances, member.name)[instance].tobytes() for member in fields(scene.instances)[1:]),
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
def test_after_an_edit_and_its_reverse_the_scene_is_what_a_new_reader_reads(stage, followed, name):
    for _ in range(3):
        EDITS[name](stage)
        scene = followed()
        assert flat(scene) == flat(Reader().read(bpy.context.evaluated_depsgraph_get()))


@pytest.mark.parametrize("seed", range(4))
def test_after_any_edits_the_scene_is_what_a_new_reader_reads(stage, followed, seed):
    chance = random.Random(seed)
    for _ in range(30):
        names = chance.choices(list(EDITS), k=chance.randint(1, 3))
        for name in names:
            EDITS[name](stage)
        scene = followed()
        assert flat(scene) == flat(Reader().read(bpy.context.evaluated_depsgraph_get())), names


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
def test_only_what_changed_is_another_object(stage, followed, name, new, monkeypatch):
    before = followed()
    monkeypatch.setattr(instances, "_raw", None)  # no mesh is read
    EDITS[name](stage)
    after = followed()
    parts = ("meshes", "instances", "materials", "images", "lights", "world")
    assert {part for part in parts if getattr(before, part) != getattr(after, part)} == new
    assert (after is before) == (not new)


def test_only_the_edited_mesh_is_another_object(stage, followed):
    before = followed()
    EDITS["move a vertex"](stage)
    after = followed()
    assert len(set(before.meshes) - set(after.meshes)) == 1
    assert after.instances is before.instances


def test_a_mesh_that_is_read_again_and_is_the_same_stays_the_same_object(stage, followed):
    before = followed()
    stage.first.data.update()
    stage.first.update_tag(refresh={"DATA"})
    assert followed() is before


def test_what_a_view_does_not_show_is_left_out_and_comes_back(stage):
    reader, depsgraph = Reader(), bpy.context.evaluated_depsgraph_get()
    everything = reader.read(depsgraph)
    without = reader.read(depsgraph, shown=lambda thing: thing.name != "holder", whole=True)
    assert len(without.instances.mesh) == len(everything.instances.mesh) - 1
    assert flat(reader.read(depsgraph, whole=True)) == flat(everything)
    assert np.isfinite(everything.extent)
