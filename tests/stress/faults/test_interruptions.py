# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders that end from outside, run beside others, or start in a handler."""

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

#: Start of a script for a new interpreter: sets up a small scene, and defines render(name).
SCRIPT = """
import bpy, signal, sys, threading, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # SIGINT is ignored if the parent process ignores it
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


def start_script(folder: Path, *lines: str) -> subprocess.Popen:
    """Start SCRIPT with further lines in a new process; its output can be read."""
    command = [sys.executable, "-c", "\n".join([SCRIPT, *lines]), folder]
    return subprocess.Popen(command, cwd=project.ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def output_of(process: subprocess.Popen, status: int = 0) -> str:
    """What the process printed, after it has ended with this exit status and no traceback."""
    try:
        out, error = process.communicate(timeout=60)
    finally:
        process.kill()  # a process that did not end would slow down all other tests
    assert process.returncode == status, error
    assert "Traceback" not in error
    return out


@pytest.fixture(scope="module")
def reference(tmp_path_factory) -> dict[str, np.ndarray]:
    """The picture of a script that does nothing else."""
    folder = tmp_path_factory.mktemp("alone")
    output_of(start_script(folder, "render('picture')"))
    return exr.read(folder / "picture.exr")


def is_same(path: Path, expected: dict[str, np.ndarray]) -> bool:
    channels = exr.read(path)
    return channels.keys() == expected.keys() and all(
        np.array_equal(channels[name], expected[name]) for name in channels
    )


def test_exit_while_a_viewport_is_drawn(tmp_path):
    lines = (
        "from ism_addon.gpu.jobs.job import Request",
        "from ism_addon.gpu.jobs.render_thread import shared",
        "from tests.scenes.small import box_over_plane",
        "from tests.support.jobs import LONG, wait_for_picture",
        "assert wait_for_picture(shared.start(Request(*box_over_plane(320, 200), LONG), 'viewport'))",
        "print('drawing')",
    )
    assert output_of(start_script(tmp_path, *lines)).endswith("drawing\n")


@pytest.mark.alone
@pytest.mark.skipif(sys.platform == "win32", reason="sends a signal as it is done elsewhere")
@pytest.mark.parametrize(
    ("signal_number", "status", "printed"),
    [(signal.SIGINT, 0, "'Error: The render was interrupted\\n'"), (signal.SIGTERM, -signal.SIGTERM, "")],
    ids=["Ctrl+C", "killed"],
)
def test_exit_while_rendering(tmp_path, signal_number, status, printed):
    """Ctrl+C raises an error in the script; SIGTERM, which render farm managers send, ends the process soon."""
    lines = (
        "scene.ism.render.samples = 65536",
        "threading.Thread(target=lambda: (time.sleep(1.0), print('rendering', flush=True))).start()",
        "try:",
        "    render('picture')",
        "except RuntimeError as error:",
        "    print(repr(str(error)))",
    )
    process = start_script(tmp_path, *lines)
    assert any("rendering" in line for line in process.stdout)
    process.send_signal(signal_number)
    before = time.monotonic()
    assert printed in output_of(process, status)
    assert time.monotonic() - before < 5.0


def test_unregistered_while_rendering(tmp_path):
    """From another thread or a render handler: Blender would crash, so it is refused; after the render it works."""
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
    output = output_of(start_script(tmp_path, *lines)).splitlines()
    sentence = "ISM is rendering: it can be disabled when the render has ended"
    assert {line for line in output if line.endswith(sentence)} == {f"True {sentence}", f"False {sentence}"}


def test_two_renders_at_once(tmp_path, reference):
    """By two processes: each draws the picture that it would draw alone."""
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(lambda name: output_of(start_script(tmp_path, f"render({name!r})")), ["one", "other"]))
    assert all(is_same(tmp_path / f"{name}.exr", reference) for name in ("one", "other"))


def test_a_render_beside_a_viewport(tmp_path, reference):
    """In one process, whose one render thread draws both."""
    lines = (
        "from ism_addon.gpu.jobs.job import Request",
        "from ism_addon.gpu.jobs.render_thread import shared",
        "from tests.scenes.small import box_over_plane",
        "from tests.support.jobs import LONG, wait_for_picture",
        "job = shared.start(Request(*box_over_plane(64, 40), LONG), 'viewport')",
        "assert wait_for_picture(job)",
        "render('picture')",
        "assert not job.finished",
    )
    output_of(start_script(tmp_path, *lines))
    assert is_same(tmp_path / "picture.exr", reference)


#: Not frame_change_post and render_stats: Blender crashes or hangs there, with Cycles too.
@pytest.mark.parametrize(
    ("handlers", "trigger"),
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
def test_a_render_from_a_handler(tmp_path, reference, handlers, trigger):
    """The nested render and the one whose handler started it both draw the picture that they would draw alone."""
    lines = (
        "calls = []",
        "@bpy.app.handlers.persistent",
        "def handler(*_):",
        "    calls.append(1)",
        "    if len(calls) == 1:",
        "        render('from handler')",
        f"bpy.app.handlers.{handlers}.append(handler)",
        trigger,
        "assert calls",
        f"bpy.app.handlers.{handlers}.clear()",  # the engine's own too
    )
    output_of(start_script(tmp_path, *lines))
    pictures = sorted(tmp_path.glob("*.exr"))
    assert tmp_path / "from handler.exr" in pictures
    assert all(is_same(path, reference) for path in pictures)


def test_a_render_in_the_background(tmp_path):
    """Without a window: a scene that cannot be rendered raises one error of one sentence in the script."""
    lines = (
        "assert bpy.app.background",
        "scene.camera = None",
        "try:",
        "    bpy.ops.render.render()",
        "except RuntimeError as error:",
        "    print(repr(str(error)))",
    )
    last_line = output_of(start_script(tmp_path, *lines)).splitlines()[-1]
    assert last_line == repr("Error: Cannot render, no camera\n")
