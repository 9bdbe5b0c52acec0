# SPDX-License-Identifier: GPL-3.0-or-later
"""Light linking: what collections, their children and their states come to, beside Cycles."""

import bpy
import numpy as np
import pytest

from ism_addon.blender.sync import camera, scene_reader
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.scene import MAX_LINK_GROUPS
from ism_addon.settings import SSAO, Quality, Settings
from tests.scenes.cycles import direct_light

NAMES = ("left", "right", "lid")


@pytest.fixture
def things(empty_scene, add):
    """Two plates side by side, a lid over both, and a lamp over that; seen from between."""
    corners = {"left": (-2, 0, 0), "right": (0, 2, 0), "lid": (-2, 2, 1)}
    found = {
        name: add(name, ([(a, -2, z), (b, -2, z), (b, 2, z), (a, 2, z)], [(0, 1, 2, 3)]))
        for name, (a, b, z) in corners.items()
    }
    light = bpy.data.lights.new("lamp", "AREA")
    light.size, light.energy = 0.05, 50.0
    found["lamp"] = add("lamp", light)
    found["lamp"].location = 0, 0, 1.6
    data = bpy.data.cameras.new("camera")
    data.lens, data.clip_start = 20.0, 0.01
    empty_scene.camera = add("camera", data)
    empty_scene.camera.location = 0, 0, 0.9
    empty_scene.render.resolution_x, empty_scene.render.resolution_y = 32, 16
    return found


def linked(things, role: str, **states: str) -> bpy.types.Collection:
    """A collection of the things named, in these states, as the lamp's."""
    collection = bpy.data.collections.new(role)
    for name in states:
        collection.objects.link(things[name])
    for link, thing in zip(collection.collection_objects, collection.objects, strict=True):
        link.light_linking.link_state = states[thing.name]
    setattr(things["lamp"].light_linking, f"{role}_collection", collection)
    return collection


def halves(picture: np.ndarray) -> tuple[bool, bool]:
    """Whether the left and the right are lit."""
    return bool(picture[4:12, 2:14, 0].mean() > 1e-3), bool(picture[4:12, 18:30, 0].mean() > 1e-3)


def drawn(device) -> np.ndarray:
    depsgraph = bpy.context.evaluated_depsgraph_get()
    renderer = Renderer(device)
    settings = Settings(ssao=SSAO(enabled=False), quality=Quality(samples=1))
    for _ in renderer.sample(scene_reader.scene(depsgraph), camera.final_view(depsgraph), settings, 0, Profile()):
        pass
    return renderer.picture()


CASES = {
    "none": ({}, {}, (False, False)),
    "an empty receiver collection": (None, {"lid": "EXCLUDE"}, (True, True)),
    "no lid": ({}, {"lid": "EXCLUDE"}, (True, True)),
    "only the left casts": ({}, {"left": "INCLUDE"}, (True, True)),
    "only the lid casts": ({}, {"lid": "INCLUDE"}, (False, False)),
    "the left alone": ({"left": "INCLUDE"}, {"lid": "EXCLUDE"}, (True, False)),
    "not the left": ({"left": "EXCLUDE"}, {"lid": "EXCLUDE"}, (False, True)),
    "right, and not left": ({"left": "EXCLUDE", "right": "INCLUDE"}, {"lid": "EXCLUDE"}, (False, True)),
}


@pytest.mark.parametrize("case", CASES)
def test_what_is_lit_is_what_cycles_lights(device, things, case):
    receivers, blockers, lit = CASES[case]
    for role, states in (("receiver", receivers), ("blocker", blockers)):
        if states or states is None:
            linked(things, role, **(states or {}))
    bpy.context.view_layer.update()
    assert halves(drawn(device)) == lit
    assert halves(direct_light(4)) == lit


def test_the_children_of_a_collection_are_linked_with_it(things):
    collection, child = linked(things, "receiver"), bpy.data.collections.new("child")
    child.objects.link(things["right"])
    collection.children.link(child)
    scene = scene_reader.scene(bpy.context.evaluated_depsgraph_get())
    assert scene.lights.receivers.tolist() == [0]
    assert scene.lights.blockers.tolist() == [-1]
    assert sorted(scene.instances.groups.tolist()) == [0, 0, 1]
    collection.collection_children[0].light_linking.link_state = "EXCLUDE"
    scene = scene_reader.scene(bpy.context.evaluated_depsgraph_get())
    assert sorted(scene.instances.groups.tolist()) == [0, 1, 1]


def test_lights_that_are_linked_alike_share_a_group_and_too_many_are_told_of(things, add):
    for number in range(MAX_LINK_GROUPS + 2):
        other = add(f"lamp {number}", bpy.data.lights.new("lamp", "AREA"))
        other.data.energy = 10.0
        collection = bpy.data.collections.new("group")
        for name in NAMES if number % 2 else NAMES[:1]:
            collection.objects.link(things[name])
        other.light_linking.receiver_collection = collection
    scene = scene_reader.scene(bpy.context.evaluated_depsgraph_get())
    assert set(scene.lights.receivers.tolist()) == {-1, 0, 1}
    for number in range(MAX_LINK_GROUPS + 2):
        thing = add(f"thing {number}", ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]))
        bpy.data.objects[f"lamp {number}"].light_linking.receiver_collection.objects.link(thing)
    scene = scene_reader.scene(bpy.context.evaluated_depsgraph_get())
    assert set(scene.lights.receivers.tolist()) == {-1, *range(MAX_LINK_GROUPS)}
    (warning,) = scene.warnings
    told = f"Lights are linked to no more than {MAX_LINK_GROUPS} groups, others are not linked: 'lamp"
    assert warning.startswith(told)


@pytest.mark.parametrize("which", ["left", "instancer"])
def test_of_instances_what_makes_them_stand_is_linked_too(device, things, add, which):
    """A second left plate, where the right one was, by an empty that instances it."""
    things["lid"].hide_render = things["right"].hide_render = True
    inside = bpy.data.collections.new("inside")
    inside.objects.link(things["left"])
    things["instancer"] = add("instancer", None)
    things["instancer"].instance_type, things["instancer"].instance_collection = "COLLECTION", inside
    things["instancer"].location = 2, 0, 0
    linked(things, "receiver", **{which: "INCLUDE"})
    depsgraph_shows_what_renders()
    found = halves(drawn(device))
    assert found == halves(direct_light(4))
    assert found == ((True, True) if which == "left" else (False, True))


def depsgraph_shows_what_renders() -> None:
    """As a viewport's, which `drawn` reads, goes by other switches."""
    for thing in bpy.data.objects:
        thing.hide_viewport = thing.hide_render
