# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders that are ended from outside, or begun where nobody would expect one."""

import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from tests.support import exr
from tests.tools import project

#: Renders a small picture, in an interpreter of its own; what comes before, between and after is the test's.
SCRIPT = """
import bpy, signal, sys, threading, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # else it is ignored where it is by whoever started the tests
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
    try:
        out, error = process.communicate(timeout=60)
    finally:
        process.kill()  # else what does not end would draw on beside all other tests
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


def test_exit_while_a_viewport_is_drawn(tmp_path):
    lines = (
        "from ism_addon.gpu.jobs.job import Request",
        "from ism_addon.gpu.jobs.render_thread import shared",
        "from tests.scenes.small import box_over_plane",
        "from tests.support.jobs import LONG, begun",
        "assert begun(shared.start(Request(*box_over_plane(320, 200), LONG), 'viewport'))",
        "print('drawing')",
    )
    assert done(script(tmp_path, *lines)).endswith("drawing\n")


@pytest.mark.alone
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


def test_unregistered_while_rendering(tmp_path):
    """By another thread, or a handler of the render: Blender would crash, so it is refused, and can be done later."""
    lines = (
        "scene.ism.render.samples, scene.ism.render.error_threshold = 600, 0.0",
        "def unregister(*_):",
        "    try:",
        "        addon.unregister()",
        "    except RuntimeError as error:",
        "        sys.stdout.write(f'{threading.current_thread() is thread} {error}\\n')",
        "thread = threading.Timer(0.5, unregister)",
        "thread.start()",
        "bpy.app.handlers.render_stats.append(unregister)",
        "render('picture')",
        "bpy.app.handlers.render_stats.clear()",
        "thread.join()",
        "addon.register()",  # as Blender does where the extension is enabled again
        "scene.ism.render.samples = 4",
        "render('picture')",
        "unregister()",
        "unregister()",
    )
    said = done(script(tmp_path, *lines)).splitlines()
    sentence = "ISM is rendering: it can be disabled when the render has ended"
    assert {line for line in said if line.endswith(sentence)} == {f"True {sentence}", f"False {sentence}"}


def test_two_renders_at_once(tmp_path, alone):
    """Of two processes, each has the picture that it would have alone."""
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda name: done(script(tmp_path, f"render({name!r})")), ["one", "other"]))
    assert all(same(tmp_path / f"{name}.exr", alone) for name in ("one", "other"))


def test_a_render_beside_a_viewport(tmp_path, alone):
    """In one process, by one thread."""
    lines = (
        "from ism_addon.gpu.jobs.job import Request",
        "from ism_addon.gpu.jobs.render_thread import shared",
        "from tests.scenes.small import box_over_plane",
        "from tests.support.jobs import LONG, begun",
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
