# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist does with objects as a whole: the picture follows, and comes back."""

from collections.abc import Callable
from pathlib import Path

import bpy

from tests.gui import follow, scenery
from tests.gui.scenario import scenario
from tests.gui.stage import Stage, Steps

GREEN = (0.05, 0.8, 0.1)


@scenario(region=(480, 360))
def hidden_and_shown(stage: Stage) -> Steps:
    """Objects are hidden in each way that Blender has, and shown again."""
    scenery.studio()
    group = scenery.collection("Group", bpy.data.objects["Ball"])
    stage.scene.collection.children.link(group)
    in_layer = stage.view_layer.layer_collection.children["Group"]
    first = yield from follow.settle(stage)
    switches = {
        "object, H": (lambda: _hide(stage, "Ball"), bpy.ops.object.hide_view_clear),
        "object, in all viewports": _switch(bpy.data.objects["Cube"], "hide_viewport"),
        "lamp, in all viewports": _switch(bpy.data.objects["Lamp"], "hide_viewport"),
        "collection, excluded": _switch(in_layer, "exclude"),
        "collection, by the eye": _switch(in_layer, "hide_viewport"),
        "collection, in all viewports": _switch(group, "hide_viewport"),
        "kind, meshes": _switch(stage.space, "show_object_viewport_mesh", False),
        "kind, lights": _switch(stage.space, "show_object_viewport_light", False),
    }
    for name, (hide, show) in switches.items():
        yield from follow.changed(stage, f"{name} hidden", hide, first)
        yield from follow.same(stage, f"{name} shown", show, first)
    hidden = yield from follow.changed(stage, "hidden for an edit", lambda: _hide(stage, "Ball"), first)
    yield from follow.same(stage, "edited unseen", lambda: _stretch("Ball"), hidden)
    yield from follow.changed(stage, "shown after the edit", bpy.ops.object.hide_view_clear, first)


@scenario(region=(480, 360))
def local_view(stage: Stage) -> Steps:
    """Local view, what is taken out of it, and local collections: the picture follows, and comes back."""
    scenery.studio()
    stage.scene.collection.children.link(scenery.collection("Group", bpy.data.objects["Ball"]))
    first = yield from follow.settle(stage)
    local = yield from follow.changed(stage, "local view", lambda: _local(stage, "Ball", "Floor", "Lamp"), first)
    yield from follow.changed(stage, "moved in it", lambda: _move("Ball", -1.0), local)
    yield from follow.same(stage, "moved back", lambda: _move("Ball", 1.0), local)
    yield from follow.changed(stage, "removed from it", lambda: _leave_local(stage, "Ball"), local)
    yield from follow.same(stage, "back", _local_view, first)
    yield from follow.changed(stage, "of one without light", lambda: _local(stage, "Cube"), first)
    yield from follow.same(stage, "back from one", _local_view, first)
    stage.space.use_local_collections = True
    yield from follow.changed(stage, "local collection hidden", lambda: _toggle_last_collection(stage), first)
    stage.space.use_local_collections = False
    yield from follow.same(stage, "local collections off", lambda: None, first)


@scenario(region=(480, 360))
def renamed(stage: Stage) -> Steps:
    """Things that are renamed look as before, and are still known by what they are."""
    scenery.studio()
    for name, color in {"Cube": (0.9, 0.05, 0.05), "Ball": (0.05, 0.1, 0.9)}.items():
        bpy.data.objects[name].data.materials.append(scenery.material(name, color))
    first = yield from follow.settle(stage)
    for kind in ("objects", "meshes", "materials"):
        yield from follow.same(stage, f"{kind} swap names", lambda kind=kind: _swap_names(kind, "Cube", "Ball"), first)
    moved = yield from follow.changed(stage, "renamed object moved", lambda: _move("Cube", 0.7), first)
    shaped = yield from follow.changed(stage, "renamed mesh edited", lambda: _stretch("Cube"), moved)
    yield from follow.changed(stage, "renamed material recoloured", lambda: scenery.recolour("Cube", GREEN), shaped)


@scenario(region=(480, 360))
def copied_and_deleted(stage: Stage) -> Steps:
    """Objects are duplicated, linked too, deleted and appended; undone and done again."""
    scenery.studio()
    first = yield from follow.settle(stage)
    path = stage.folder / "library.blend"
    _write_library(path)
    acts = {
        "duplicated": lambda: _duplicate(stage, "Ball", linked=False),
        "copy edited": lambda: _stretch(bpy.data.objects["Ball.001"].data.name),
        "linked": lambda: _duplicate(stage, "Cube", linked=True),
        "both edited": lambda: _stretch("Cube"),
        "deleted": lambda: _delete(stage, "Ball", "Cube"),
        "appended": lambda: bpy.ops.wm.append(directory=f"{path}/Object/", filename="Sign"),
        "appended material recoloured": lambda: scenery.recolour("Paint", GREEN),
    }
    pictures = [first]
    for name, act in acts.items():
        pictures.append((yield from follow.changed(stage, name, act, pictures[-1])))
        stage.remember(name)
    undone = list(zip(acts, pictures, strict=False))
    for name, before in reversed(undone):
        yield from follow.same(stage, f"{name}, undone", bpy.ops.ed.undo, before)
    for name, after in zip(acts, pictures[1:], strict=True):
        yield from follow.same(stage, f"{name}, redone", bpy.ops.ed.redo, after)


def _swap_names(kind: str, one: str, other: str) -> None:
    things = getattr(bpy.data, kind)
    first, second = things[one], things[other]
    first.name, second.name, first.name = "Third", one, other


def _write_library(path: Path) -> None:
    """A file with a painted sign in it, of which nothing is left here."""
    sign = scenery.add("Sign", scenery.cube(0.8), (0.3, -1.6, 0.4))
    sign.data.materials.append(scenery.material("Paint", (0.9, 0.05, 0.05)))
    bpy.data.libraries.write(str(path), {sign})
    bpy.data.batch_remove([sign, sign.data, *sign.data.materials])


def _duplicate(stage: Stage, name: str, linked: bool) -> None:
    _select(stage, name)
    bpy.ops.object.duplicate(linked=linked)
    stage.view_layer.objects.selected[0].location.y -= 1.8


def _delete(stage: Stage, *names: str) -> None:
    _select(stage, *names)
    bpy.ops.object.delete()


def _stretch(name: str) -> None:
    scenery.stretch(bpy.data.meshes[name])


def _toggle_last_collection(stage: Stage) -> None:
    bpy.ops.object.hide_collection(collection_index=len(stage.scene.collection.children), toggle=True)


def _local_view() -> None:
    bpy.ops.view3d.localview(frame_selected=False)


def _local(stage: Stage, *names: str) -> None:
    _select(stage, *names)
    _local_view()


def _leave_local(stage: Stage, *names: str) -> None:
    _select(stage, *names)
    bpy.ops.view3d.localview_remove_from()


def _move(name: str, across: float) -> None:
    bpy.data.objects[name].location.x += across


def _hide(stage: Stage, *names: str) -> None:
    _select(stage, *names)
    bpy.ops.object.hide_view_set()


def _select(stage: Stage, *names: str) -> None:
    for thing in stage.view_layer.objects:
        thing.select_set(thing.name in names)


def _switch(owner: object, name: str, value: bool = True) -> tuple[Callable, Callable]:
    """Turn a switch, and turn it back."""
    return lambda: setattr(owner, name, value), lambda: setattr(owner, name, not value)
