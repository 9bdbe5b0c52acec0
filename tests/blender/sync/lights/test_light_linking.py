# SPDX-License-Identifier: GPL-3.0-or-later
"""Light linking by collections, their children and their link states, compared with Cycles."""

import bpy
import numpy as np
import pytest

from ism_addon.blender.sync import camera, scene_reader
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.scene import MAX_LINK_GROUPS
from ism_addon.settings import SSAO, Quality, Settings
from tests.blender.render.test_cycles import emissive_material
from tests.scenes.cycles import direct_light

SMALL_SQUARE = ([(-0.02, -0.02, 0), (0.02, -0.02, 0), (0.02, 0.02, 0), (-0.02, 0.02, 0)], [(0, 1, 2, 3)])
NAMES = ("left", "right", "lid")


@pytest.fixture
def objects(request, empty_scene, add):
    """Two plates side by side, a lid above both, a light above the lid, and a camera between plates and lid.

    The light is a lamp, or the mesh SMALL_SQUARE.
    """
    corners = {"left": (-2, 0, 0), "right": (0, 2, 0), "lid": (-2, 2, 1)}
    objects = {
        name: add(name, ([(a, -2, z), (b, -2, z), (b, 2, z), (a, 2, z)], [(0, 1, 2, 3)]))
        for name, (a, b, z) in corners.items()
    }
    light = bpy.data.lights.new("lamp", "AREA")
    light.size, light.energy = 0.05, 50.0
    mesh = getattr(request, "param", None)
    objects["light"] = add("lamp", light if mesh is None else mesh)
    if mesh is not None:
        objects["light"].data.materials.append(emissive_material("Emission", 1e4))
    objects["light"].location = 0, 0, 1.6
    data = bpy.data.cameras.new("camera")
    data.lens, data.clip_start = 20.0, 0.01
    empty_scene.camera = add("camera", data)
    empty_scene.camera.location = 0, 0, 0.9
    empty_scene.render.resolution_x, empty_scene.render.resolution_y = 32, 16
    return objects


def link_to_light(objects, role: str, **states: str) -> bpy.types.Collection:
    """Make a collection of the named objects with these link states, as the light's collection of this role."""
    collection = bpy.data.collections.new(role)
    for name in states:
        collection.objects.link(objects[name])
    for link, thing in zip(collection.collection_objects, collection.objects, strict=True):
        link.light_linking.link_state = states[thing.name]
    setattr(objects["light"].light_linking, f"{role}_collection", collection)
    return collection


def lit_halves(picture: np.ndarray) -> tuple[bool, bool]:
    """Whether the left and the right plate are lit."""
    return bool(picture[4:12, 2:14, 0].mean() > 1e-3), bool(picture[4:12, 18:30, 0].mean() > 1e-3)


def draw(device) -> np.ndarray:
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


@pytest.mark.parametrize("objects", [None, SMALL_SQUARE], ids=["lamp", "emissive mesh"], indirect=True)
@pytest.mark.parametrize("case", CASES)
def test_the_same_plates_are_lit_as_by_cycles(device, objects, case):
    receivers, blockers, lit = CASES[case]
    for role, states in (("receiver", receivers), ("blocker", blockers)):
        if states or states is None:
            link_to_light(objects, role, **(states or {}))
    bpy.context.view_layer.update()
    assert lit_halves(draw(device)) == lit
    assert lit_halves(direct_light(4)) == lit


def test_the_children_of_a_collection_are_linked_with_it(objects):
    collection, child = link_to_light(objects, "receiver"), bpy.data.collections.new("child")
    child.objects.link(objects["right"])
    collection.children.link(child)
    scene = scene_reader.scene(bpy.context.evaluated_depsgraph_get())
    assert scene.lights.receivers.tolist() == [0]
    assert scene.lights.blockers.tolist() == [-1]
    assert sorted(scene.instances.groups.tolist()) == [0, 0, 1]
    collection.collection_children[0].light_linking.link_state = "EXCLUDE"
    scene = scene_reader.scene(bpy.context.evaluated_depsgraph_get())
    assert sorted(scene.instances.groups.tolist()) == [0, 1, 1]


def test_lights_with_the_same_links_share_a_group_and_too_many_groups_are_reported(objects, add):
    for index in range(MAX_LINK_GROUPS + 2):
        other = add(f"lamp {index}", bpy.data.lights.new("lamp", "AREA"))
        other.data.energy = 10.0
        collection = bpy.data.collections.new("group")
        for name in NAMES if index % 2 else NAMES[:1]:
            collection.objects.link(objects[name])
        other.light_linking.receiver_collection = collection
    scene = scene_reader.scene(bpy.context.evaluated_depsgraph_get())
    assert set(scene.lights.receivers.tolist()) == {-1, 0, 1}
    for index in range(MAX_LINK_GROUPS + 2):
        thing = add(f"thing {index}", ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]))
        bpy.data.objects[f"lamp {index}"].light_linking.receiver_collection.objects.link(thing)
    scene = scene_reader.scene(bpy.context.evaluated_depsgraph_get())
    assert set(scene.lights.receivers.tolist()) == {-1, *range(MAX_LINK_GROUPS)}
    (warning,) = scene.warnings
    expected = f"Lights are linked to no more than {MAX_LINK_GROUPS} groups, others are not linked: 'lamp"
    assert warning.startswith(expected)


@pytest.mark.parametrize("which", ["left", "instancer"])
def test_links_of_an_object_and_of_its_instancer_apply_to_instances(device, objects, add, which):
    """An empty instances the left plate at the position of the right plate, which is hidden."""
    objects["lid"].hide_render = objects["right"].hide_render = True
    inside = bpy.data.collections.new("inside")
    inside.objects.link(objects["left"])
    objects["instancer"] = add("instancer", None)
    objects["instancer"].instance_type, objects["instancer"].instance_collection = "COLLECTION", inside
    objects["instancer"].location = 2, 0, 0
    link_to_light(objects, "receiver", **{which: "INCLUDE"})
    hide_in_viewports_as_in_renders()
    lit = lit_halves(draw(device))
    assert lit == lit_halves(direct_light(4))
    assert lit == ((True, True) if which == "left" else (False, True))


def hide_in_viewports_as_in_renders() -> None:
    """Hide the same objects for `draw`, which reads a viewport's depsgraph: that obeys hide_viewport."""
    for thing in bpy.data.objects:
        thing.hide_viewport = thing.hide_render
