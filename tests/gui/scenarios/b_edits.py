# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist does with the scene, undone and done again: the picture follows, at once."""

import math
import time
from collections.abc import Callable

import bpy
import numpy as np

from tests.gui import engine, scene_setup
from tests.gui.scenario import scenario
from tests.gui.screenshots import rmse
from tests.gui.session import Session, Steps

MIDDLE = (0.5, 0.3)
#: Display values by which pictures of the same may differ: screenshots are rounded, and sampling is repeatable.
SAME = 1.5 / 255


def shine(light: bpy.types.Light) -> None:
    light.color, light.energy = (1.0, 0.1, 0.1), 250.0


LIGHT_EDITS: dict[str, Callable[[bpy.types.Object], None]] = {
    "moved": lambda lamp: setattr(lamp, "location", (-3.0, -1.0, 2.0)),
    "rotated": lambda lamp: setattr(lamp, "rotation_euler", (0.0, math.radians(100.0), 0.0)),
    "scaled": lambda lamp: setattr(lamp, "scale", (0.15, 0.15, 0.15)),
    "resized": lambda lamp: setattr(lamp.data, "size", 6.0),
    "recoloured": lambda lamp: shine(lamp.data),
}


@scenario(patience=240)
def light(session: Session) -> Steps:
    """A light moved, rotated, scaled, resized and recoloured; each undone and done again."""
    scene_setup.studio()
    yield from _settle(session)
    for name, edit in LIGHT_EDITS.items():
        yield from _edit_and_undo(session, f"light {name}", MIDDLE, lambda edit=edit: edit(bpy.data.objects["Lamp"]))


@scenario(patience=180)
def mesh(session: Session) -> Steps:
    """A mesh edited in Object Mode; undone and done again."""
    scene_setup.studio()
    yield from _settle(session)
    stretch = lambda: scene_setup.stretch(bpy.data.objects["Cube"].data)  # noqa: E731
    yield from _edit_and_undo(session, "mesh edited", session.pixel_of((-0.9, 0.0, 1.5)), stretch)


@scenario(patience=180)
def edit_mode(session: Session) -> Steps:
    """A mesh edited in Edit Mode shows before that is left."""
    scene_setup.studio()
    yield from _settle(session)
    before = session.pixels("before")
    with session.in_viewport():
        session.view_layer.objects.active = bpy.data.objects["Cube"]
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.transform.resize(value=(1.0, 1.0, 2.5))
    yield from session.until_idle()
    inside = session.pixels("in Edit Mode")
    assert rmse(inside, before) > 0.01, "the picture does not follow in Edit Mode"
    with session.in_viewport():
        bpy.ops.object.mode_set(mode="OBJECT")
    yield from session.until_idle()
    after = session.pixels("in Object Mode")
    session.measured("Edit Mode against Object Mode, RMSE", 255 * rmse(inside, after), "/255", must=1.5)


@scenario(patience=180)
def ambient_occlusion(session: Session) -> Steps:
    """The sliders of the ambient occlusion change the picture, and changed back give the first."""
    scene_setup.studio()
    scene_setup.world(0.7)
    bpy.data.lights["Lamp"].energy = 10.0
    ssao = session.scene.ism.ssao
    ssao.radius = 1.0
    yield from _settle(session)
    before = session.pixels("before")
    for name, value in {
        "radius": 2.0,
        "cone_angle": 1.0,
        "intensity": 3.0,
        "attenuation": 6.0,
        "enabled": False,
    }.items():
        was = getattr(ssao, name)
        setattr(ssao, name, value)
        yield from session.until_idle()
        changed = abs(session.pixels(name) - before).max()
        session.measured(f"{name} changed a pixel by at most", 255 * changed, "/255")
        assert changed > 8 / 255, f"{name} does nothing"
        setattr(ssao, name, was)
        yield from session.until_idle()
        back = rmse(session.pixels(f"{name} back"), before)
        session.measured(f"{name} changed back", 255 * back, "/255", must=255 * SAME)


@scenario(patience=240)
def among_many(session: Session) -> Steps:
    """One object is moved among 500,000 triangles."""
    scene_setup.crowd()
    yield from session.until_drawn(9.0)
    session.measured("triangles", scene_setup.triangles())
    session.pixels("before")
    place = session.pixel_of((0.0, -0.5, 0.35))
    since = time.perf_counter()
    free = bpy.data.objects["Free"]
    seconds = yield from session.until_visible(lambda: setattr(free, "location", (3.0, -0.5, 0.35)), place)
    yield from session.until_idle()
    session.pixels("after")
    extraction = 1e3 * session.calls.longest_update(since)
    uploads = engine.milliseconds("UploadMeshes", "UploadInstances", "UploadMaterials", "BuildTLAS")
    session.measured("extraction", extraction, "ms")
    session.measured("extraction and upload", extraction + uploads, "ms", must=10, aim=2)
    session.measured("longest redraw with it", 1e3 * session.calls.longest_redraw(since), "ms", must=30, aim=10)
    session.measured("first picture after the move", seconds, "s", must=1, aim=0.25)
    seconds = yield from session.until_visible(
        lambda: scene_setup.recolour("Red", (0.05, 0.1, 0.9)), session.pixel_of((3.0, -0.5, 0.35))
    )
    session.measured("first picture after a new colour", seconds, "s", must=1, aim=0.25)
    yield from session.until_idle()
    seconds = yield from session.until_visible(lambda: shine(bpy.data.lights["Lamp"]), MIDDLE)
    session.measured("first picture after a recoloured light", seconds, "s", must=1, aim=0.25)
    yield from session.until_idle()


def _settle(session: Session) -> Steps:
    yield from session.until_drawn()
    session.remember("Before")


def _edit_and_undo(session: Session, name: str, place: tuple[float, float], edit: Callable[[], None]) -> Steps:
    """Edit, undo, redo, undo: the picture is another one, the first, the other and the first again."""
    first = session.pixels(f"{name} 0 before")
    since = time.perf_counter()
    seconds = yield from session.until_visible(edit, place)
    yield from session.until_idle()
    session.remember(name)
    session.measured(f"{name}: first picture", seconds, "s", must=1, aim=0.25)
    session.measured(f"{name}: longest redraw", 1e3 * session.calls.longest_redraw(since), "ms", must=30, aim=10)
    other = session.pixels(f"{name} 1 done")
    assert rmse(first, other) > 0.01, f"{name}: the picture does not follow"
    yield from _step(session, name, "2 undone", bpy.ops.ed.undo, first)
    yield from _step(session, name, "3 redone", bpy.ops.ed.redo, other)
    yield from _step(session, name, "4 undone", bpy.ops.ed.undo, first)


def _step(session: Session, name: str, step: str, operator: Callable, expected: np.ndarray) -> Steps:
    with session.in_viewport():
        operator()
    yield from session.until_idle()
    difference = 255 * rmse(session.pixels(f"{name} {step}"), expected)
    session.measured(f"{name} {step}, RMSE", difference, "/255", must=255 * SAME)
