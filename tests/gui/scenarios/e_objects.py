# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist does with objects as a whole: the picture follows, and comes back."""

from collections.abc import Callable
from pathlib import Path

import bpy

from tests.gui import scene_setup, updates
from tests.gui.scenario import scenario
from tests.gui.session import Session, Steps

GREEN = (0.05, 0.8, 0.1)


@scenario(region=(480, 360))
def hidden_and_shown(session: Session) -> Steps:
    """Objects are hidden in each way that Blender has, and shown again."""
    scene_setup.studio()
    group = scene_setup.collection("Group", bpy.data.objects["Ball"])
    session.scene.collection.children.link(group)
    in_layer = session.view_layer.layer_collection.children["Group"]
    first = yield from updates.settle(session)
    switches = {
        "object, H": (lambda: _hide(session, "Ball"), bpy.ops.object.hide_view_clear),
        "object, in all viewports": _switch(bpy.data.objects["Cube"], "hide_viewport"),
        "lamp, in all viewports": _switch(bpy.data.objects["Lamp"], "hide_viewport"),
        "collection, excluded": _switch(in_layer, "exclude"),
        "collection, by the eye": _switch(in_layer, "hide_viewport"),
        "collection, in all viewports": _switch(group, "hide_viewport"),
        "kind, meshes": _switch(session.space, "show_object_viewport_mesh", False),
        "kind, lights": _switch(session.space, "show_object_viewport_light", False),
    }
    for name, (hide, show) in switches.items():
        yield from updates.changed(session, f"{name} hidden", hide, first)
        yield from updates.assert_unchanged(session, f"{name} shown", show, first)
    hidden = yield from updates.changed(session, "hidden for an edit", lambda: _hide(session, "Ball"), first)
    yield from updates.assert_unchanged(session, "edited unseen", lambda: _stretch("Ball"), hidden)
    yield from updates.changed(session, "shown after the edit", bpy.ops.object.hide_view_clear, first)


@scenario(region=(480, 360))
def local_view(session: Session) -> Steps:
    """Local view, what is taken out of it, and local collections: the picture follows, and comes back."""
    scene_setup.studio()
    session.scene.collection.children.link(scene_setup.collection("Group", bpy.data.objects["Ball"]))
    first = yield from updates.settle(session)
    local = yield from updates.changed(session, "local view", lambda: _local(session, "Ball", "Floor", "Lamp"), first)
    yield from updates.changed(session, "moved in it", lambda: _move("Ball", -1.0), local)
    yield from updates.assert_unchanged(session, "moved back", lambda: _move("Ball", 1.0), local)
    yield from updates.changed(session, "removed from it", lambda: _leave_local(session, "Ball"), local)
    yield from updates.assert_unchanged(session, "back", _local_view, first)
    yield from updates.changed(session, "of one without light", lambda: _local(session, "Cube"), first)
    yield from updates.assert_unchanged(session, "back from one", _local_view, first)
    session.space.use_local_collections = True
    yield from updates.changed(session, "local collection hidden", lambda: _toggle_last_collection(session), first)
    session.space.use_local_collections = False
    yield from updates.assert_unchanged(session, "local collections off", lambda: None, first)


@scenario(region=(480, 360))
def renamed(session: Session) -> Steps:
    """Things that are renamed look as before, and are still known by what they are."""
    scene_setup.studio()
    for name, color in {"Cube": (0.9, 0.05, 0.05), "Ball": (0.05, 0.1, 0.9)}.items():
        bpy.data.objects[name].data.materials.append(scene_setup.material(name, color))
    first = yield from updates.settle(session)
    for kind in ("objects", "meshes", "materials"):
        yield from updates.assert_unchanged(
            session, f"{kind} swap names", lambda kind=kind: _swap_names(kind, "Cube", "Ball"), first
        )
    moved = yield from updates.changed(session, "renamed object moved", lambda: _move("Cube", 0.7), first)
    shaped = yield from updates.changed(session, "renamed mesh edited", lambda: _stretch("Cube"), moved)
    yield from updates.changed(
        session, "renamed material recoloured", lambda: scene_setup.recolour("Cube", GREEN), shaped
    )


@scenario(region=(480, 360))
def copied_and_deleted(session: Session) -> Steps:
    """Objects are duplicated, linked too, deleted and appended; undone and done again."""
    scene_setup.studio()
    first = yield from updates.settle(session)
    path = session.folder / "library.blend"
    _write_library(path)
    acts = {
        "duplicated": lambda: _duplicate(session, "Ball", linked=False),
        "copy edited": lambda: _stretch(bpy.data.objects["Ball.001"].data.name),
        "linked": lambda: _duplicate(session, "Cube", linked=True),
        "both edited": lambda: _stretch("Cube"),
        "deleted": lambda: _delete(session, "Ball", "Cube"),
        "appended": lambda: bpy.ops.wm.append(directory=f"{path}/Object/", filename="Sign"),
        "appended material recoloured": lambda: scene_setup.recolour("Paint", GREEN),
    }
    pictures = [first]
    for name, act in acts.items():
        pictures.append((yield from updates.changed(session, name, act, pictures[-1])))
        session.remember(name)
    undone = list(zip(acts, pictures, strict=False))
    for name, before in reversed(undone):
        yield from updates.assert_unchanged(session, f"{name}, undone", bpy.ops.ed.undo, before)
    for name, after in zip(acts, pictures[1:], strict=True):
        yield from updates.assert_unchanged(session, f"{name}, redone", bpy.ops.ed.redo, after)


def _swap_names(kind: str, one: str, other: str) -> None:
    things = getattr(bpy.data, kind)
    first, second = things[one], things[other]
    first.name, second.name, first.name = "Third", one, other


def _write_library(path: Path) -> None:
    """A file with a painted sign in it, of which nothing is left here."""
    sign = scene_setup.add("Sign", scene_setup.cube(0.8), (0.3, -1.6, 0.4))
    sign.data.materials.append(scene_setup.material("Paint", (0.9, 0.05, 0.05)))
    bpy.data.libraries.write(str(path), {sign})
    bpy.data.batch_remove([sign, sign.data, *sign.data.materials])


def _duplicate(session: Session, name: str, linked: bool) -> None:
    _select(session, name)
    bpy.ops.object.duplicate(linked=linked)
    session.view_layer.objects.selected[0].location.y -= 1.8


def _delete(session: Session, *names: str) -> None:
    _select(session, *names)
    bpy.ops.object.delete()


def _stretch(name: str) -> None:
    scene_setup.stretch(bpy.data.meshes[name])


def _toggle_last_collection(session: Session) -> None:
    bpy.ops.object.hide_collection(collection_index=len(session.scene.collection.children), toggle=True)


def _local_view() -> None:
    bpy.ops.view3d.localview(frame_selected=False)


def _local(session: Session, *names: str) -> None:
    _select(session, *names)
    _local_view()


def _leave_local(session: Session, *names: str) -> None:
    _select(session, *names)
    bpy.ops.view3d.localview_remove_from()


def _move(name: str, across: float) -> None:
    bpy.data.objects[name].location.x += across


def _hide(session: Session, *names: str) -> None:
    _select(session, *names)
    bpy.ops.object.hide_view_set()


def _select(session: Session, *names: str) -> None:
    for thing in session.view_layer.objects:
        thing.select_set(thing.name in names)


def _switch(owner: object, name: str, value: bool = True) -> tuple[Callable, Callable]:
    """Turn a switch, and turn it back."""
    return lambda: setattr(owner, name, value), lambda: setattr(owner, name, not value)
