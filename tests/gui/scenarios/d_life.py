# SPDX-License-Identifier: GPL-3.0-or-later
"""Final renders, file loads and a disabled extension while the viewport renders; memory after many edits."""

import math
import random
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np

from tests.gui import engine, random_edits, scene_setup
from tests.gui.heartbeat import Heartbeat
from tests.gui.scenario import scenario
from tests.gui.screenshots import read_png
from tests.gui.session import Session, Steps
from tests.tools.memory import resident

LOAD_COUNT, EDIT_COUNT = 20, 300
UPDATE_COUNT = 1000
MANY_SAMPLES = 4096  # more than any scenario waits for


@scenario(timeout=180)
def final_render(session: Session) -> Steps:
    """F12 renders while the viewport renders, and Blender's main loop keeps running."""
    yield from _render_for_long(session)
    _prepare_final(session)
    completed = []
    bpy.app.handlers.render_complete.append(lambda *_: completed.append(True))
    with Heartbeat() as heartbeat:
        with bpy.context.temp_override(window=session.window):
            bpy.ops.render.render("INVOKE_DEFAULT", write_still=True)
        yield from session.until(lambda: completed and not bpy.app.is_job_running("RENDER"), 90, "F12 is done")
    session.record("longest gap of a 100 Hz timer", 1e3 * heartbeat.longest_gap, "ms", must=100, aim=40)
    _assert_final(session)
    session.scene.ism.viewport.samples = 4
    yield from session.until_idle()
    assert session.pixels("viewport").std() > 0.05


@scenario(timeout=180, alone=True)
def from_a_timer_and_to_the_end(session: Session) -> Steps:
    """A timer renders while the viewport renders; then Blender is closed during F12."""
    yield from _render_for_long(session)
    _prepare_final(session)
    with bpy.context.temp_override(window=session.window):
        assert bpy.ops.render.render(write_still=True) == {
            "FINISHED"
        }  # by a timer: each step of a scenario is run by one
    _assert_final(session)
    assert engine.is_busy()
    session.scene.ism.render.samples, session.scene.ism.render.error_threshold = MANY_SAMPLES, 0.0
    with bpy.context.temp_override(window=session.window):
        bpy.ops.render.render("INVOKE_DEFAULT")
    yield from session.wait(1.0)
    assert bpy.app.is_job_running("RENDER")


@scenario(timeout=180)
def file_load(session: Session) -> Steps:
    """A file is loaded while the viewport renders, and then shown."""
    scene_setup.build_studio()
    yield from session.until_drawn()
    first = session.pixels("saved")
    path = _save(session)
    yield from _render_for_long(session)
    yield from _load(session, path)
    session.record("loaded against saved, largest", 255 * abs(session.pixels("loaded") - first).max(), "/255", must=2)


@scenario(timeout=180, alone=True)
def disabled_and_enabled(session: Session) -> Steps:
    """The extension is disabled and enabled again while the viewport renders, twice."""
    for time in ("first", "second"):
        yield from _render_for_long(session)
        bpy.ops.preferences.addon_disable(module=engine.PACKAGE)
        yield from session.wait(1.0)
        assert not hasattr(bpy.types.Scene, "ism"), "the extension is still there"
        bpy.ops.preferences.addon_enable(module=engine.PACKAGE)
        session.show_rendered()
        session.scene.ism.viewport.samples = 4
        yield from session.until_idle()
        assert session.pixels(f"after the {time} time").std() > 0.05, "no picture after the extension has come back"


@scenario(region=(240, 160), timeout=400, alone=True)
def long_day(session: Session) -> Steps:
    """300 random edits and 20 file loads: no errors, and memory does not grow."""
    scene_setup.build_studio()
    scene_setup.set_view(session.view)
    session.show_rendered()
    session.scene.ism.viewport.samples = 4
    path = _save(session)
    rng = random.Random(1)
    sizes = []
    for _ in range(LOAD_COUNT):
        yield from _load(session, path)
        sizes.append(resident())
        for _ in range(EDIT_COUNT // LOAD_COUNT):
            edit: Callable = rng.choice((*random_edits.EDITS, *random_edits.UNDO_AND_REDO))
            print(edit.__name__, flush=True)  # the log shows the last edit before a crash
            edit(session, rng)
            if edit not in random_edits.UNDO_AND_REDO:
                # As all operators do: Blender 4.3 itself crashes at an undo after edits without an undo step.
                session.push_undo(edit.__name__)
            yield from session.wait(rng.choice((0.0, 0.05, 0.2)))
            assert not engine.errors(), f"{edit.__name__}: {engine.errors()}"
    yield from _load(session, path)
    sizes.append(resident())
    # The first loads fill caches: Blender's undo steps, shaders, the allocator's arenas. After them, a size lies
    # 30 MB above or below another by what was drawn last; the line through all of them shows growth.
    sizes = sizes[LOAD_COUNT // 4 :]
    growth, baseline = np.polyfit(np.linspace(0.0, 1.0, len(sizes)), sizes, deg=1)
    session.record("memory after a quarter", baseline / 1e6, "MB")
    session.record("growth of memory in the rest", growth / 1e6, "MB", must=50, aim=10)
    assert session.pixels("at the end").std() > 0.05


@scenario(region=(240, 160), timeout=240, alone=True)
def thousand_updates(session: Session) -> Steps:
    """A light and an object are moved a thousand times: memory and threads are as after the first 200."""
    scene_setup.build_studio()
    scene_setup.set_view(session.view)
    session.hide_overlays()
    session.show_rendered()
    session.scene.ism.viewport.samples = 2
    light, mesh = (next(obj for obj in bpy.data.objects if obj.type == type_) for type_ in ("LIGHT", "MESH"))
    memory, threads = [], []
    for update in range(UPDATE_COUNT):
        if update % (UPDATE_COUNT // 10) == 0:
            yield from session.until_idle()
            memory.append(resident())
            threads.append(len(list(Path("/proc/self/task").iterdir())))
        light.location.x, mesh.rotation_euler.z = math.sin(update), 0.1 * update
        yield from session.wait(0.02)
    yield from session.until_idle()
    assert not engine.errors(), engine.errors()
    session.record("growth of memory after the first 200", (resident() - memory[2]) / 1e6, "MB", must=20, aim=0)
    session.record("threads that came after the first 200", max(threads[2:]) - threads[2], "", must=0)


def _render_for_long(session: Session) -> Steps:
    """Show the studio with so many samples that the viewport is still rendering afterwards."""
    scene_setup.build_studio()
    scene_setup.set_view(session.view)
    session.hide_overlays()
    quality = session.scene.ism.viewport
    quality.samples, quality.error_threshold = MANY_SAMPLES, 0.0
    session.show_rendered()
    yield from session.wait(2.0)
    assert engine.is_busy()


def _prepare_final(session: Session) -> None:
    """Add a camera and set up F12: a small picture that is saved, in no window of its own."""
    scene_setup.add_camera()
    render = session.scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = 320, 240, 100
    render.filepath = str(session.folder / "final.png")
    bpy.context.preferences.view.render_display_type = "NONE"


def _assert_final(session: Session) -> None:
    """The picture of F12 is saved, and not empty."""
    final = read_png(session.folder / "final.png")
    assert final.max() - final.min() > 0.3, "the final picture is empty"


def _save(session: Session) -> Path:
    path = session.folder / "studio.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def _load(session: Session, path: Path) -> Steps:
    bpy.ops.wm.open_mainfile(filepath=str(path))
    session.show_rendered()  # Blender opens files in Solid shading
    yield from session.until_idle()
