# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders that are cancelled, ended from outside, or begun where nobody would expect one."""

import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import bpy
import mathutils
import numpy as np
import pytest

from ism_addon import addon
from ism_addon.blender import engine, final, geometry
from ism_addon.gpu import renderer
from ism_addon.gpu.job import Request

from ..blender import exr
from ..scenes.small import box_over_plane
from ..test_worker import LONG, begun
from ..tools import project

#: What the passes of samples by rays are, in their order.
PASSES = [kind.__name__ for kind in (*renderer.BEFORE, *renderer.FITTED, *renderer.AFTER, renderer.JUDGED)]

#: s: an answer later than this is none.
SOON = 0.3

#: Renders a small picture, in an interpreter of its own; what comes before, between and after is the test's.
SCRIPT = """
import bpy, sys, threading, time
from ism_addon import addon
addon.register()
folder = sys.argv[1]
scene = bpy.context.scene
bpy.data.lights[0].type = "AREA"
scene.render.engine, scene.render.resolution_x, scene.render.resolution_y = "ISM", 96, 64
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth, scene.render.image_settings.exr_codec = "32", "NONE"
scene.ism.render.samples = 4
def render(name):
    bpy.context.scene.render.filepath = f"{folder}/{name}.exr"
    assert bpy.ops.render.render(write_still=True) == {"FINISHED"}
"""


def script(folder: Path, *lines: str) -> subprocess.Popen:
    """Begun, with all that it says to be read."""
    command = [sys.executable, "-c", "\n".join([SCRIPT, *lines]), folder]
    return subprocess.Popen(command, cwd=project.ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def done(process: subprocess.Popen, status: int = 0) -> str:
    """What it said, when it has ended as it should and without complaint."""
    out, error = process.communicate(timeout=60)
    assert process.returncode == status, error
    assert "Traceback" not in error
    return out


@pytest.fixture(scope="module")
def alone(tmp_path_factory) -> dict[str, np.ndarray]:
    """The picture of a script that does nothing else."""
    folder = tmp_path_factory.mktemp("alone")
    done(script(folder, "render('picture')"))
    return exr.read(folder / "picture.exr")


def same(path: Path, expected: dict[str, np.ndarray]) -> bool:
    found = exr.read(path)
    return found.keys() == expected.keys() and all(np.array_equal(found[name], expected[name]) for name in found)


class Cancelled(bpy.types.RenderEngine):
    """Ours, whose user presses Escape when `press` says so; a class derived from ours could not be asked that."""

    bl_idname = "ISM_CANCELLED"
    bl_label = "ISM, cancelled"
    pressed = float("inf")
    answered = 0.0

    @classmethod
    def press(cls) -> None:
        cls.pressed = min(cls.pressed, time.monotonic())

    def update_render_passes(self, scene, layer):
        engine.ISMRenderEngine.update_render_passes(self, scene, layer)

    def render(self, depsgraph):
        final.render(Watched(self), depsgraph)
        Cancelled.answered = time.monotonic()


class Watched:
    """An engine, but for what its user does."""

    def __init__(self, real: bpy.types.RenderEngine):
        self.real = real

    def __getattr__(self, name):
        return getattr(self.real, name)

    def test_break(self) -> bool:
        return Cancelled.pressed < float("inf")


@pytest.fixture
def cancelled(tmp_path):
    """cancelled(): the picture of a render that is cancelled, and how late, s. The worker's thread begins with it."""
    bpy.ops.wm.read_factory_settings()
    addon.register()
    bpy.utils.register_class(Cancelled)
    Cancelled.pressed = float("inf")
    scene = bpy.context.scene
    bpy.data.lights[0].type = "AREA"
    scene.render.engine, scene.render.filepath = Cancelled.bl_idname, str(tmp_path / "picture.exr")
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth, scene.render.image_settings.exr_codec = "32", "NONE"
    scene.render.resolution_x, scene.render.resolution_y = 320, 180
    scene.ism.render.samples, scene.ism.render.error_threshold = 65536, 0.0

    def cancelled() -> tuple[np.ndarray, float]:
        bpy.ops.render.render(write_still=True)
        channels = exr.read(tmp_path / "picture.exr")
        assert Cancelled.pressed < float("inf")
        return np.stack([channels[name] for name in "RGB"], -1), Cancelled.answered - Cancelled.pressed

    yield cancelled
    bpy.utils.unregister_class(Cancelled)
    addon.unregister()


@pytest.mark.parametrize("sample", [0, 3])
@pytest.mark.parametrize("stage", PASSES)
def test_cancel_in_a_pass(cancelled, monkeypatch, within, stage, sample):
    """Of the first sample, with its shaders still to be compiled, or of a later one, when there is a picture."""
    run = renderer.Renderer.run

    def run_and_press(self, kind, frame, profile) -> str:
        if kind.__name__ == stage and frame.sample == sample:
            Cancelled.press()
        return run(self, kind, frame, profile)

    monkeypatch.setattr(renderer.Renderer, "run", run_and_press)
    picture, late = cancelled()
    assert np.isfinite(picture).all()
    assert picture.any() or sample == 0
    within(late, SOON)


def test_cancel_while_the_scene_is_read(cancelled, monkeypatch, within):
    """Of a thousand objects, hardly one is read any more."""
    for _ in range(1000):
        bpy.context.collection.objects.link(bpy.data.objects.new("Cube", bpy.data.meshes["Cube"].copy()))
    read, count = geometry.meshes.read, []

    def read_and_press(*arguments):
        count.append(arguments)
        Cancelled.press()
        return read(*arguments)

    monkeypatch.setattr(geometry.meshes, "read", read_and_press)
    picture, late = cancelled()
    assert not picture.any()
    assert len(count) == 1
    within(late, SOON)
    monkeypatch.undo()
    Cancelled.pressed = float("inf")
    bpy.context.scene.render.engine, bpy.context.scene.ism.render.samples = "ISM", 1
    bpy.ops.render.render()
    assert engine.statistics()["triangles"] == 12 * 1001


def test_what_changed_before_a_cancelled_reading_is_read_by_the_next(cancelled, monkeypatch):
    """With Persistent Data too, when Blender tells of a change only once."""
    scene, mesh = bpy.context.scene, bpy.data.meshes["Cube"]
    scene.render.use_persistent_data, scene.ism.render.samples = True, 1
    bpy.ops.render.render()
    mesh.transform(mathutils.Matrix.Scale(3.0, 4))
    Cancelled.press()
    bpy.ops.render.render()
    Cancelled.pressed = float("inf")
    read = []
    real = final.Request
    monkeypatch.setattr(final, "Request", lambda scene, *more: read.append(scene) or real(scene, *more))
    bpy.ops.render.render()
    assert max(abs(mesh.positions).max() for mesh in read[0].meshes) == 3.0


def test_exit_while_a_viewport_is_drawn(tmp_path):
    lines = (
        "from ism_addon.gpu.job import Request",
        "from ism_addon.gpu.worker import shared",
        "from tests.scenes.small import box_over_plane",
        "from tests.test_worker import LONG, begun",
        "assert begun(shared.start(Request(*box_over_plane(320, 200), LONG), 'viewport'))",
        "print('drawing')",
    )
    assert done(script(tmp_path, *lines)).endswith("drawing\n")


@pytest.mark.skipif(sys.platform == "win32", reason="sends a signal as it is done elsewhere")
@pytest.mark.parametrize(
    ("number", "status", "said"),
    [(signal.SIGINT, 0, "'Error: The render was interrupted\\n'"), (signal.SIGTERM, -signal.SIGTERM, "")],
    ids=["Ctrl+C", "killed"],
)
def test_exit_while_rendering(tmp_path, number, status, said):
    """A script can tell what has happened; what a farm's manager sends ends it at once."""
    lines = (
        "scene.ism.render.samples = 65536",
        "threading.Thread(target=lambda: (time.sleep(1.0), print('rendering', flush=True))).start()",
        "try:",
        "    render('picture')",
        "except RuntimeError as error:",
        "    print(repr(str(error)))",
    )
    process = script(tmp_path, *lines)
    assert any("rendering" in line for line in process.stdout)
    process.send_signal(number)
    before = time.monotonic()
    assert said in done(process, status)
    assert time.monotonic() - before < 5.0


def test_two_renders_at_once(tmp_path, alone):
    """Of two processes, each has the picture that it would have alone."""
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda name: done(script(tmp_path, f"render({name!r})")), ["one", "other"]))
    assert all(same(tmp_path / f"{name}.exr", alone) for name in ("one", "other"))


def test_a_render_beside_a_viewport(tmp_path, alone):
    """In one process, by one thread."""
    lines = (
        "from ism_addon.gpu.job import Request",
        "from ism_addon.gpu.worker import shared",
        "from tests.scenes.small import box_over_plane",
        "from tests.test_worker import LONG, begun",
        "job = shared.start(Request(*box_over_plane(64, 40), LONG), 'viewport')",
        "assert begun(job)",
        "render('picture')",
        "assert not job.finished",
    )
    done(script(tmp_path, *lines))
    assert same(tmp_path / "picture.exr", alone)


#: Not frame_change_post and render_stats: Blender crashes or hangs there, with Cycles too.
@pytest.mark.parametrize(
    ("handlers", "act"),
    [
        ("load_post", "bpy.ops.wm.save_as_mainfile(filepath=f'{folder}/a.blend'); bpy.ops.wm.revert_mainfile()"),
        ("save_post", "bpy.ops.wm.save_as_mainfile(filepath=f'{folder}/a.blend')"),
        ("depsgraph_update_post", "bpy.context.object.location.x += 0.0; bpy.context.view_layer.update()"),
        ("render_init", "render('picture')"),
        ("render_pre", "render('picture')"),
        ("render_post", "render('picture')"),
        ("render_write", "render('picture')"),
        ("render_complete", "render('picture')"),
    ],
)
def test_a_render_from_a_handler(tmp_path, alone, handlers, act):
    """It has the picture that it would have alone; and so has the render in which that was begun."""
    lines = (
        "calls = []",
        "@bpy.app.handlers.persistent",
        "def handler(*_):",
        "    calls.append(1)",
        "    if len(calls) == 1:",
        "        render('from handler')",
        f"bpy.app.handlers.{handlers}.append(handler)",
        act,
        "assert calls",
        f"bpy.app.handlers.{handlers}.clear()",  # of our own too
    )
    done(script(tmp_path, *lines))
    pictures = sorted(tmp_path.glob("*.exr"))
    assert tmp_path / "from handler.exr" in pictures
    assert all(same(path, alone) for path in pictures)


def test_a_render_in_the_background(tmp_path):
    """`bpy.app.background`: what cannot be drawn is one error for the script, and one sentence."""
    lines = (
        "assert bpy.app.background",
        "scene.camera = None",
        "try:",
        "    bpy.ops.render.render()",
        "except RuntimeError as error:",
        "    print(repr(str(error)))",
    )
    said = done(script(tmp_path, *lines)).splitlines()[-1]
    assert said == repr("Error: Cannot render, no camera\n")


def test_a_viewport_is_drawn_while_its_render_is_cancelled(worker):
    """Clients have nothing to do with one another."""
    jobs = [worker.start(Request(*box_over_plane(24, 16), LONG), client) for client in ("viewport", "final")]
    assert all(begun(job) for job in jobs)
    jobs[1].cancel()
    before = jobs[0].samples_done
    while jobs[0].samples_done == before:
        jobs[0].wait(1.0)
    assert not jobs[0].finished
