# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of lights, meshes and settings, undone and redone: the viewport shows each, and soon."""

import math
import time
from collections.abc import Callable

import bpy
import numpy as np

from tests.gui import engine, scene_setup
from tests.gui.scenario import scenario
from tests.gui.screenshots import rmse
from tests.gui.session import Session, Steps

FLOOR_UV = (0.5, 0.3)  # of the region: on the floor in the middle
#: RMSE of display values between pictures of the same scene: screenshots are rounded, and sampling is repeatable.
MAX_RMSE = 1.5 / 255


def recolor_light(light: bpy.types.Light) -> None:
    light.color, light.energy = (1.0, 0.1, 0.1), 250.0


LIGHT_EDITS: dict[str, Callable[[bpy.types.Object], None]] = {
    "moved": lambda light: setattr(light, "location", (-3.0, -1.0, 2.0)),
    "rotated": lambda light: setattr(light, "rotation_euler", (0.0, math.radians(100.0), 0.0)),
    "scaled": lambda light: setattr(light, "scale", (0.15, 0.15, 0.15)),
    "resized": lambda light: setattr(light.data, "size", 6.0),
    "recoloured": lambda light: recolor_light(light.data),
}


@scenario(timeout=240)
def light(session: Session) -> Steps:
    """A light is moved, rotated, scaled, resized and recoloured; each edit is undone and redone."""
    scene_setup.build_studio()
    yield from _show_first(session)
    for name, edit in LIGHT_EDITS.items():
        yield from _assert_undoable(
            session, f"light {name}", FLOOR_UV, lambda edit=edit: edit(bpy.data.objects["Lamp"])
        )


def set_type(kind: str, energy: float) -> None:
    """Give the lamp another type."""
    bpy.data.lights["Lamp"].type = kind
    bpy.data.lights["Lamp"].energy = energy


def light_up(strength: float) -> None:
    """Let the ball emit."""
    shader = bpy.data.materials["Glow"].node_tree.nodes["Principled BSDF"]
    shader.inputs["Emission Color"].default_value = (1.0, 0.5, 0.2, 1.0)
    shader.inputs["Emission Strength"].default_value = strength


@scenario(timeout=240)
def light_types(session: Session) -> Steps:
    """The lamp becomes a point, a spot and a sun, then the ball and the world emit; each edit is undone."""
    scene_setup.build_studio()
    bpy.data.objects["Ball"].data.materials.append(scene_setup.new_material("Glow", (0.5, 0.5, 0.5)))
    yield from _show_first(session)
    edits: dict[str, Callable[[], None]] = {
        "point": lambda: set_type("POINT", 1000.0),
        "spot": lambda: set_type("SPOT", 3000.0),
        "sun": lambda: set_type("SUN", 1.0),
        "emissive ball": lambda: light_up(10.0),
        "world": lambda: scene_setup.set_world(1.0, shadows=True),
    }
    for name, edit in edits.items():
        old = session.pixels(f"{name} 0 before")
        seconds = yield from session.until_visible(edit, FLOOR_UV)
        session.record(f"{name}: first picture", seconds, "s", must=1, aim=0.25)
        yield from session.until_idle()
        session.push_undo(name)
        assert rmse(old, session.pixels(f"{name} 1 done")) > 0.01, f"{name}: the picture has not changed"
        yield from _undo_or_redo(session, name, "2 undone", bpy.ops.ed.undo, old)


@scenario(timeout=180)
def mesh(session: Session) -> Steps:
    """A mesh is edited in Object Mode; undone and redone."""
    scene_setup.build_studio()
    yield from _show_first(session)
    stretch = lambda: scene_setup.stretch(bpy.data.objects["Cube"].data)  # noqa: E731
    yield from _assert_undoable(session, "mesh edited", session.region_uv((-0.9, 0.0, 1.5)), stretch)


@scenario(timeout=180)
def edit_mode(session: Session) -> Steps:
    """A mesh edited in Edit Mode is shown before that mode is left."""
    scene_setup.build_studio()
    yield from _show_first(session)
    before = session.pixels("before")
    with session.in_viewport():
        session.view_layer.objects.active = bpy.data.objects["Cube"]
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.transform.resize(value=(1.0, 1.0, 2.5))
    yield from session.until_idle()
    in_edit_mode = session.pixels("in Edit Mode")
    assert rmse(in_edit_mode, before) > 0.01, "the picture has not changed in Edit Mode"
    with session.in_viewport():
        bpy.ops.object.mode_set(mode="OBJECT")
    yield from session.until_idle()
    after = session.pixels("in Object Mode")
    session.record("Edit Mode against Object Mode, RMSE", 255 * rmse(in_edit_mode, after), "/255", must=1.5)


@scenario(region=(480, 336), timeout=180, any_size=False)
def ambient_occlusion(session: Session) -> Steps:
    """Each setting of the ambient occlusion changes the picture; changed back, it restores the first picture."""
    scene_setup.build_studio()
    scene_setup.set_world(0.7)
    bpy.data.lights["Lamp"].energy = 10.0
    ssao = session.scene.ism.ssao
    ssao.radius = 1.0
    yield from _show_first(session)
    before = session.pixels("before")
    for name, value in {
        "radius": 2.0,
        "cone_angle": 1.0,
        "intensity": 3.0,
        "attenuation": 6.0,
        "enabled": False,
    }.items():
        old_value = getattr(ssao, name)
        setattr(ssao, name, value)
        yield from session.until_idle()
        changed = abs(session.pixels(name) - before).max()
        session.record(f"{name} changed a pixel by at most", 255 * changed, "/255")
        assert changed > 8 / 255, f"{name} changes nothing"
        setattr(ssao, name, old_value)
        yield from session.until_idle()
        restored = rmse(session.pixels(f"{name} back"), before)
        session.record(f"{name} changed back", 255 * restored, "/255", must=255 * MAX_RMSE)


@scenario(timeout=240)
def among_many(session: Session) -> Steps:
    """In a scene of 500,000 triangles, an object is moved, and a material and a light are recoloured."""
    scene_setup.build_many_balls()
    yield from session.until_drawn(9.0)
    session.record("triangles", scene_setup.triangle_count())
    session.pixels("before")
    uv = session.region_uv((0.0, -0.5, 0.35))
    since = time.perf_counter()
    free = bpy.data.objects["Free"]
    seconds = yield from session.until_visible(lambda: setattr(free, "location", (3.0, -0.5, 0.35)), uv)
    yield from session.until_idle()
    session.pixels("after")
    extraction = 1e3 * session.calls.longest_update(since)
    uploads = engine.pass_milliseconds("UploadMeshes", "UploadInstances", "UploadMaterials", "BuildTLAS")
    session.record("extraction", extraction, "ms")
    session.record("extraction and upload", extraction + uploads, "ms", must=10, aim=2)
    session.record("longest redraw with it", 1e3 * session.calls.longest_redraw(since), "ms", must=30, aim=10)
    session.record("first picture after the move", seconds, "s", must=1, aim=0.25)
    seconds = yield from session.until_visible(
        lambda: scene_setup.recolor("Red", (0.05, 0.1, 0.9)), session.region_uv((3.0, -0.5, 0.35))
    )
    session.record("first picture after a new colour", seconds, "s", must=1, aim=0.25)
    yield from session.until_idle()
    seconds = yield from session.until_visible(lambda: recolor_light(bpy.data.lights["Lamp"]), FLOOR_UV)
    session.record("first picture after a recoloured light", seconds, "s", must=1, aim=0.25)
    yield from session.until_idle()


def _show_first(session: Session) -> Steps:
    yield from session.until_drawn()
    session.push_undo("Before")


def _assert_undoable(session: Session, name: str, uv: tuple[float, float], edit: Callable[[], None]) -> Steps:
    """Edit, undo, redo, undo: the picture changes, then is the old, the new and the old one."""
    old = session.pixels(f"{name} 0 before")
    since = time.perf_counter()
    seconds = yield from session.until_visible(edit, uv)
    yield from session.until_idle()
    session.push_undo(name)
    session.record(f"{name}: first picture", seconds, "s", must=1, aim=0.25)
    session.record(f"{name}: longest redraw", 1e3 * session.calls.longest_redraw(since), "ms", must=30, aim=10)
    new = session.pixels(f"{name} 1 done")
    assert rmse(old, new) > 0.01, f"{name}: the picture has not changed"
    yield from _undo_or_redo(session, name, "2 undone", bpy.ops.ed.undo, old)
    yield from _undo_or_redo(session, name, "3 redone", bpy.ops.ed.redo, new)
    yield from _undo_or_redo(session, name, "4 undone", bpy.ops.ed.undo, old)


def _undo_or_redo(session: Session, name: str, step: str, operator: Callable, expected: np.ndarray) -> Steps:
    with session.in_viewport():
        operator()
    yield from session.until_idle()
    difference = 255 * rmse(session.pixels(f"{name} {step}"), expected)
    session.record(f"{name} {step}, RMSE", difference, "/255", must=255 * MAX_RMSE)
