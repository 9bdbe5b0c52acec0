# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects are hidden, renamed, copied and deleted: the viewport shows each edit, and its reversal."""

from collections.abc import Callable
from pathlib import Path

import bpy

from tests.gui import scene_setup, updates
from tests.gui.scenario import scenario
from tests.gui.session import Session, Steps

GREEN = (0.05, 0.8, 0.1)


@scenario(region=(480, 360))
def hidden_and_shown(session: Session) -> Steps:
    """Objects are hidden in each way that Blender offers, and shown again."""
    scene_setup.build_studio()
    group = scene_setup.move_to_collection("Group", bpy.data.objects["Ball"])
    session.scene.collection.children.link(group)
    in_layer = session.view_layer.layer_collection.children["Group"]
    first = yield from updates.first_picture(session)
    switches = {
        "object, H": (lambda: _hide(session, "Ball"), bpy.ops.object.hide_view_clear),
        "object, in all viewports": _set_and_reset(bpy.data.objects["Cube"], "hide_viewport"),
        "lamp, in all viewports": _set_and_reset(bpy.data.objects["Lamp"], "hide_viewport"),
        "collection, excluded": _set_and_reset(in_layer, "exclude"),
        "collection, by the eye": _set_and_reset(in_layer, "hide_viewport"),
        "collection, in all viewports": _set_and_reset(group, "hide_viewport"),
        "kind, meshes": _set_and_reset(session.space, "show_object_viewport_mesh", False),
        "kind, lights": _set_and_reset(session.space, "show_object_viewport_light", False),
    }
    for name, (hide, show) in switches.items():
        yield from updates.assert_changed(session, f"{name} hidden", hide, first)
        yield from updates.assert_unchanged(session, f"{name} shown", show, first)
    hidden = yield from updates.assert_changed(session, "hidden for an edit", lambda: _hide(session, "Ball"), first)
    yield from updates.assert_unchanged(session, "edited unseen", lambda: _stretch("Ball"), hidden)
    yield from updates.assert_changed(session, "shown after the edit", bpy.ops.object.hide_view_clear, first)


@scenario(region=(480, 360))
def local_view(session: Session) -> Steps:
    """Local view, objects removed from it, and local collections: the viewport shows each, and its reversal."""
    scene_setup.build_studio()
    session.scene.collection.children.link(scene_setup.move_to_collection("Group", bpy.data.objects["Ball"]))
    first = yield from updates.first_picture(session)
    local = yield from updates.assert_changed(
        session, "local view", lambda: _enter_local_view(session, "Ball", "Floor", "Lamp"), first
    )
    yield from updates.assert_changed(session, "moved in it", lambda: _move("Ball", -1.0), local)
    yield from updates.assert_unchanged(session, "moved back", lambda: _move("Ball", 1.0), local)
    yield from updates.assert_changed(
        session, "removed from it", lambda: _remove_from_local_view(session, "Ball"), local
    )
    yield from updates.assert_unchanged(session, "back", _toggle_local_view, first)
    yield from updates.assert_changed(
        session, "of one without light", lambda: _enter_local_view(session, "Cube"), first
    )
    yield from updates.assert_unchanged(session, "back from one", _toggle_local_view, first)
    session.space.use_local_collections = True
    yield from updates.assert_changed(
        session, "local collection hidden", lambda: _toggle_last_collection(session), first
    )
    session.space.use_local_collections = False
    yield from updates.assert_unchanged(session, "local collections off", lambda: None, first)


@scenario(region=(480, 360))
def renamed(session: Session) -> Steps:
    """Renamed objects, meshes and materials look as before, and later edits of them are shown."""
    scene_setup.build_studio()
    for name, color in {"Cube": (0.9, 0.05, 0.05), "Ball": (0.05, 0.1, 0.9)}.items():
        bpy.data.objects[name].data.materials.append(scene_setup.new_material(name, color))
    first = yield from updates.first_picture(session)
    for data_type in ("objects", "meshes", "materials"):
        yield from updates.assert_unchanged(
            session,
            f"{data_type} swap names",
            lambda data_type=data_type: _swap_names(data_type, "Cube", "Ball"),
            first,
        )
    moved = yield from updates.assert_changed(session, "renamed object moved", lambda: _move("Cube", 0.7), first)
    shaped = yield from updates.assert_changed(session, "renamed mesh edited", lambda: _stretch("Cube"), moved)
    yield from updates.assert_changed(
        session, "renamed material recoloured", lambda: scene_setup.recolor("Cube", GREEN), shaped
    )


@scenario(region=(480, 360))
def copied_and_deleted(session: Session) -> Steps:
    """Objects are duplicated, with linked data too, deleted and appended; undone and redone."""
    scene_setup.build_studio()
    first = yield from updates.first_picture(session)
    path = session.folder / "library.blend"
    _write_library(path)
    actions = {
        "duplicated": lambda: _duplicate(session, "Ball", linked=False),
        "copy edited": lambda: _stretch(bpy.data.objects["Ball.001"].data.name),
        "linked": lambda: _duplicate(session, "Cube", linked=True),
        "both edited": lambda: _stretch("Cube"),
        "deleted": lambda: _delete(session, "Ball", "Cube"),
        "appended": lambda: bpy.ops.wm.append(directory=f"{path}/Object/", filename="Sign"),
        "appended material recoloured": lambda: scene_setup.recolor("Paint", GREEN),
    }
    pictures = [first]
    for name, action in actions.items():
        pictures.append((yield from updates.assert_changed(session, name, action, pictures[-1])))
        session.push_undo(name)
    before_each = list(zip(actions, pictures, strict=False))
    for name, before in reversed(before_each):
        yield from updates.assert_unchanged(session, f"{name}, undone", bpy.ops.ed.undo, before)
    for name, after in zip(actions, pictures[1:], strict=True):
        yield from updates.assert_unchanged(session, f"{name}, redone", bpy.ops.ed.redo, after)


def _swap_names(data_type: str, one: str, other: str) -> None:
    blocks = getattr(bpy.data, data_type)
    first, second = blocks[one], blocks[other]
    first.name, second.name, first.name = "Third", one, other


def _write_library(path: Path) -> None:
    """Write a file with an object "Sign" and its material, and remove both from the scene."""
    sign = scene_setup.add_object("Sign", scene_setup.cube(0.8), (0.3, -1.6, 0.4))
    sign.data.materials.append(scene_setup.new_material("Paint", (0.9, 0.05, 0.05)))
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


def _toggle_local_view() -> None:
    bpy.ops.view3d.localview(frame_selected=False)


def _enter_local_view(session: Session, *names: str) -> None:
    _select(session, *names)
    _toggle_local_view()


def _remove_from_local_view(session: Session, *names: str) -> None:
    _select(session, *names)
    bpy.ops.view3d.localview_remove_from()


def _move(name: str, distance: float) -> None:
    bpy.data.objects[name].location.x += distance


def _hide(session: Session, *names: str) -> None:
    _select(session, *names)
    bpy.ops.object.hide_view_set()


def _select(session: Session, *names: str) -> None:
    for obj in session.view_layer.objects:
        obj.select_set(obj.name in names)


def _set_and_reset(owner: object, name: str, value: bool = True) -> tuple[Callable, Callable]:
    """(set a property, set it back)."""
    return lambda: setattr(owner, name, value), lambda: setattr(owner, name, not value)
