# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist does with the scene, undone and done again: the picture follows, at once."""

import math
import time
from collections.abc import Callable

import bpy
import numpy as np

from tests.gui import engine, scenery
from tests.gui.scenario import scenario
from tests.gui.sight import rmse
from tests.gui.stage import Stage, Steps

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
def light(stage: Stage) -> Steps:
    """A light moved, rotated, scaled, resized and recoloured; each undone and done again."""
    scenery.studio()
    yield from _settle(stage)
    for name, edit in LIGHT_EDITS.items():
        yield from _edit_and_undo(stage, f"light {name}", MIDDLE, lambda edit=edit: edit(bpy.data.objects["Lamp"]))


@scenario(patience=180)
def mesh(stage: Stage) -> Steps:
    """A mesh edited in Object Mode; undone and done again."""
    scenery.studio()
    yield from _settle(stage)
    stretch = lambda: scenery.stretch(bpy.data.objects["Cube"].data)  # noqa: E731
    yield from _edit_and_undo(stage, "mesh edited", stage.place_of((-0.9, 0.0, 1.5)), stretch)


@scenario(patience=180)
def edit_mode(stage: Stage) -> Steps:
    """A mesh edited in Edit Mode shows before that is left."""
    scenery.studio()
    yield from _settle(stage)
    before = stage.pixels("before")
    with stage.in_viewport():
        stage.view_layer.objects.active = bpy.data.objects["Cube"]
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.transform.resize(value=(1.0, 1.0, 2.5))
    yield from stage.rested()
    inside = stage.pixels("in Edit Mode")
    assert rmse(inside, before) > 0.01, "the picture does not follow in Edit Mode"
    with stage.in_viewport():
        bpy.ops.object.mode_set(mode="OBJECT")
    yield from stage.rested()
    after = stage.pixels("in Object Mode")
    stage.measured("Edit Mode against Object Mode, RMSE", 255 * rmse(inside, after), "/255", must=1.5)


@scenario(patience=180)
def ambient_occlusion(stage: Stage) -> Steps:
    """The sliders of the ambient occlusion change the picture, and changed back give the first."""
    scenery.studio()
    scenery.world(0.7)
    bpy.data.lights["Lamp"].energy = 10.0
    ssao = stage.scene.ism.ssao
    ssao.radius = 1.0
    yield from _settle(stage)
    before = stage.pixels("before")
    for name, value in {
        "radius": 2.0,
        "cone_angle": 1.0,
        "intensity": 3.0,
        "attenuation": 6.0,
        "enabled": False,
    }.items():
        was = getattr(ssao, name)
        setattr(ssao, name, value)
        yield from stage.rested()
        changed = abs(stage.pixels(name) - before).max()
        stage.measured(f"{name} changed a pixel by at most", 255 * changed, "/255")
        assert changed > 8 / 255, f"{name} does nothing"
        setattr(ssao, name, was)
        yield from stage.rested()
        back = rmse(stage.pixels(f"{name} back"), before)
        stage.measured(f"{name} changed back", 255 * back, "/255", must=255 * SAME)


@scenario(patience=240)
def among_many(stage: Stage) -> Steps:
    """One object is moved among 500,000 triangles."""
    scenery.crowd()
    yield from stage.settled(9.0)
    stage.measured("triangles", scenery.triangles())
    stage.pixels("before")
    place = stage.place_of((0.0, -0.5, 0.35))
    since = time.perf_counter()
    free = bpy.data.objects["Free"]
    seconds = yield from stage.seen(lambda: setattr(free, "location", (3.0, -0.5, 0.35)), place)
    yield from stage.rested()
    stage.pixels("after")
    extraction = 1e3 * stage.watch.longest_update(since)
    uploads = engine.milliseconds("UploadMeshes", "UploadInstances", "UploadMaterials", "BuildTLAS")
    stage.measured("extraction", extraction, "ms")
    stage.measured("extraction and upload", extraction + uploads, "ms", must=10, aim=2)
    stage.measured("longest redraw with it", 1e3 * stage.watch.longest_redraw(since), "ms", must=30, aim=10)
    stage.measured("first picture after the move", seconds, "s", must=1, aim=0.25)
    seconds = yield from stage.seen(
        lambda: scenery.recolour("Red", (0.05, 0.1, 0.9)), stage.place_of((3.0, -0.5, 0.35))
    )
    stage.measured("first picture after a new colour", seconds, "s", must=1, aim=0.25)
    yield from stage.rested()
    seconds = yield from stage.seen(lambda: shine(bpy.data.lights["Lamp"]), MIDDLE)
    stage.measured("first picture after a recoloured light", seconds, "s", must=1, aim=0.25)
    yield from stage.rested()


def _settle(stage: Stage) -> Steps:
    yield from stage.settled()
    stage.remember("Before")


def _edit_and_undo(stage: Stage, name: str, place: tuple[float, float], edit: Callable[[], None]) -> Steps:
    """Edit, undo, redo, undo: the picture is another one, the first, the other and the first again."""
    first = stage.pixels(f"{name} 0 before")
    since = time.perf_counter()
    seconds = yield from stage.seen(edit, place)
    yield from stage.rested()
    stage.remember(name)
    stage.measured(f"{name}: first picture", seconds, "s", must=1, aim=0.25)
    stage.measured(f"{name}: longest redraw", 1e3 * stage.watch.longest_redraw(since), "ms", must=30, aim=10)
    other = stage.pixels(f"{name} 1 done")
    assert rmse(first, other) > 0.01, f"{name}: the picture does not follow"
    yield from _step(stage, name, "2 undone", bpy.ops.ed.undo, first)
    yield from _step(stage, name, "3 redone", bpy.ops.ed.redo, other)
    yield from _step(stage, name, "4 undone", bpy.ops.ed.undo, first)


def _step(stage: Stage, name: str, step: str, operator: Callable, expected: np.ndarray) -> Steps:
    with stage.in_viewport():
        operator()
    yield from stage.rested()
    difference = 255 * rmse(stage.pixels(f"{name} {step}"), expected)
    stage.measured(f"{name} {step}, RMSE", difference, "/255", must=255 * SAME)
