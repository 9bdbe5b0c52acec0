# SPDX-License-Identifier: GPL-3.0-or-later
"""While the viewport renders, Blender goes on with its life: final renders, files, extensions that come and go."""

import math
import random
from collections.abc import Callable
from pathlib import Path

import bpy

from tests.gui import engine, random_edits, scene_setup
from tests.gui.heartbeat import Heartbeat
from tests.gui.scenario import scenario
from tests.gui.screenshots import picture
from tests.gui.session import Session, Steps
from tests.tools.memory import resident

LOADS, EDITS = 20, 300
UPDATES = 1000
LONG = 4096  # samples that no scenario waits for


@scenario(patience=180)
def final_render(session: Session) -> Steps:
    """F12 is rendered while the viewport renders, and the window stays alive."""
    yield from _busy(session)
    _prepare_final(session)
    ended = []
    bpy.app.handlers.render_complete.append(lambda *_: ended.append(True))
    with Heartbeat() as heartbeat:
        with bpy.context.temp_override(window=session.window):
            bpy.ops.render.render("INVOKE_DEFAULT", write_still=True)
        yield from session.until(lambda: ended and not bpy.app.is_job_running("RENDER"), 90, "F12 is done")
    session.measured("longest gap of a 100 Hz timer", 1e3 * heartbeat.longest_gap, "ms", must=100, aim=40)
    _check_final(session)
    session.scene.ism.viewport.samples = 4
    yield from session.until_idle()
    assert session.pixels("viewport").std() > 0.05


@scenario(patience=180)
def from_a_timer_and_to_the_end(session: Session) -> Steps:
    """A timer renders while the viewport does; then Blender is closed in the middle of F12."""
    yield from _busy(session)
    _prepare_final(session)
    with bpy.context.temp_override(window=session.window):
        assert bpy.ops.render.render(write_still=True) == {"FINISHED"}  # each step of a scenario is a timer's
    _check_final(session)
    assert engine.is_busy()
    session.scene.ism.render.samples, session.scene.ism.render.error_threshold = LONG, 0.0
    with bpy.context.temp_override(window=session.window):
        bpy.ops.render.render("INVOKE_DEFAULT")
    yield from session.wait(1.0)
    assert bpy.app.is_job_running("RENDER")


@scenario(patience=180)
def file_load(session: Session) -> Steps:
    """Another file is loaded while the viewport renders, and is seen."""
    scene_setup.studio()
    yield from session.until_drawn()
    first = session.pixels("saved")
    path = _save(session)
    yield from _busy(session)
    yield from _load(session, path)
    session.measured("loaded against saved, largest", 255 * abs(session.pixels("loaded") - first).max(), "/255", must=2)


@scenario(patience=180)
def disabled_and_enabled(session: Session) -> Steps:
    """The extension is disabled and enabled again while the viewport renders, twice."""
    for time in ("first", "second"):
        yield from _busy(session)
        bpy.ops.preferences.addon_disable(module=engine.PACKAGE)
        yield from session.wait(1.0)
        assert not hasattr(bpy.types.Scene, "ism"), "the extension is still there"
        bpy.ops.preferences.addon_enable(module=engine.PACKAGE)
        session.rendered()
        session.scene.ism.viewport.samples = 4
        yield from session.until_idle()
        assert session.pixels(f"after the {time} time").std() > 0.05, "no picture after the extension has come back"


@scenario(region=(480, 320), patience=400)
def long_day(session: Session) -> Steps:
    """300 random edits and 20 file loads: nothing breaks, and memory does not grow."""
    scene_setup.studio()
    scene_setup.set_view(session.view)
    session.rendered()
    session.scene.ism.viewport.samples = 4
    path = _save(session)
    chance = random.Random(1)
    sizes = []
    for _ in range(LOADS):
        yield from _load(session, path)
        sizes.append(resident())
        for _ in range(EDITS // LOADS):
            edit: Callable = chance.choice((*random_edits.EDITS, *random_edits.STEPS))
            print(edit.__name__, flush=True)  # the trail to a crash
            edit(session, chance)
            if edit not in random_edits.STEPS:
                # As all operators do: Blender 4.3 itself crashes at an undo after edits that it was not told of.
                session.remember(edit.__name__)
            yield from session.wait(chance.choice((0.0, 0.05, 0.2)))
            assert not engine.errors(), f"{edit.__name__}: {engine.errors()}"
    yield from _load(session, path)
    sizes.append(resident())
    # The first rounds fill caches: Blender's undo steps, shaders, the allocator's arenas.
    warm = sizes[LOADS // 4]
    session.measured("memory after a quarter", warm / 1e6, "MB")
    session.measured("growth of memory in the rest", (sizes[-1] - warm) / 1e6, "MB", must=50, aim=10)
    assert session.pixels("at the end").std() > 0.05


@scenario(region=(480, 320), patience=240)
def thousand_updates(session: Session) -> Steps:
    """A lamp and a thing are moved a thousand times in a viewport: memory and threads are as after the first ones."""
    scene_setup.studio()
    scene_setup.set_view(session.view)
    session.without_overlays()
    session.rendered()
    session.scene.ism.viewport.samples = 2
    lamp, thing = (next(each for each in bpy.data.objects if each.type == kind) for kind in ("LIGHT", "MESH"))
    memory, threads = [], []
    for update in range(UPDATES):
        if update % (UPDATES // 10) == 0:
            yield from session.until_idle()
            memory.append(resident())
            threads.append(len(list(Path("/proc/self/task").iterdir())))
        lamp.location.x, thing.rotation_euler.z = math.sin(update), 0.1 * update
        yield from session.wait(0.02)
    yield from session.until_idle()
    assert not engine.errors(), engine.errors()
    session.measured("growth of memory after the first 200", (resident() - memory[2]) / 1e6, "MB", must=20, aim=0)
    session.measured("threads that came after the first 200", max(threads[2:]) - threads[2], "", must=0)


def _busy(session: Session) -> Steps:
    """The studio, with so many samples that the viewport is not done."""
    scene_setup.studio()
    scene_setup.set_view(session.view)
    session.without_overlays()
    quality = session.scene.ism.viewport
    quality.samples, quality.error_threshold = LONG, 0.0
    session.rendered()
    yield from session.wait(2.0)
    assert engine.is_busy()


def _prepare_final(session: Session) -> None:
    """A camera, and a small picture to be saved without a window of its own."""
    scene_setup.camera()
    render = session.scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = 320, 240, 100
    render.filepath = str(session.folder / "final.png")
    bpy.context.preferences.view.render_display_type = "NONE"


def _check_final(session: Session) -> None:
    """It has been saved, and something is on it."""
    final = picture(session.folder / "final.png")
    assert final.max() - final.min() > 0.3, "the final picture is empty"


def _save(session: Session) -> Path:
    path = session.folder / "studio.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def _load(session: Session, path: Path) -> Steps:
    bpy.ops.wm.open_mainfile(filepath=str(path))
    session.rendered()  # Blender opens files in Solid shading
    yield from session.until_idle()
