# SPDX-License-Identifier: GPL-3.0-or-later
"""Error messages where OpenGL is missing, fails or lacks memory; and drawing goes on afterwards."""

import ctypes
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Collection
from dataclasses import replace
from pathlib import Path

import moderngl
import numpy as np
import pytest

from ism_addon.gpu import memory_estimate
from ism_addon.gpu.gl.moderngl_version import NEXT_MAJOR, OLDEST
from ism_addon.gpu.jobs.job import Job
from ism_addon.gpu.jobs.render_loop import RenderLoop
from ism_addon.gpu.renderer import Renderer
from ism_addon.render_passes import RenderPass
from ism_addon.setting_limits import beyond_limits
from tests.pictures.test_reload import edit, shaders  # noqa: F401 (a fixture)
from tests.support.jobs import LONG, request, wait_for_end, wait_for_picture
from tests.support.small_scenes import SMALL_SHADOW_MAPS
from tests.tools import project

#: For a new interpreter: two clients request a picture, and the errors of both are printed.
REQUEST_TWICE = """
from ism_addon.gpu.jobs.job import Request
from ism_addon.gpu.jobs.render_thread import RenderThread
from tests.scenes.small import box_over_plane
from ism_addon.settings import Settings
worker = RenderThread()
for client in range(2):
    job = worker.start(Request(*box_over_plane(8, 8), Settings()), client)
    while not job.finished:
        job.wait(1.0)
    assert job.picture() is None
    print(job.error)
worker.stop()
"""

ON_LINUX = pytest.mark.skipif(sys.platform != "linux", reason="hides OpenGL as it is done on Linux")


def reported_error(before: str = "", **environment: object) -> str:
    """The error of a render in a new process, after the lines `before`; that of a second client must be the same."""
    completed = subprocess.run(
        [sys.executable, "-c", before + REQUEST_TWICE],
        cwd=project.ROOT,
        env=os.environ | {name: str(value) for name, value in environment.items()},
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert completed.returncode == 0, completed.stderr
    assert "Traceback" not in completed.stderr
    first, second = completed.stdout.splitlines()
    assert first == second
    return first


def is_no_opengl_error(error: str) -> bool:
    """The text in the brackets comes from moderngl or the driver: it is not compared."""
    return re.sub(r"\(.+\)", "(…)", error) == (
        "OpenGL 4.1 could not be opened (…): "
        "install the graphics card's driver, or Mesa's EGL libraries for rendering without a card"
    )


@ON_LINUX
def test_no_egl(tmp_path):
    """An invalid file of the library's name is found before the real one."""
    for name in ("libEGL.so", "libEGL.so.1"):
        (tmp_path / name).write_text("none")
    assert is_no_opengl_error(reported_error(LD_LIBRARY_PATH=tmp_path))


@ON_LINUX
def test_no_driver():
    assert is_no_opengl_error(reported_error(__EGL_VENDOR_LIBRARY_FILENAMES="/none", LIBGL_DRIVERS_PATH="/none"))


def test_an_opengl_that_is_too_old(opened_device):
    if "llvmpipe" not in opened_device.name:
        pytest.skip("only Mesa can report an older version than its own")
    assert is_no_opengl_error(reported_error(MESA_GL_VERSION_OVERRIDE="3.3"))


@pytest.mark.parametrize(
    ("before", "why"),
    [
        ("import sys; sys.modules['moderngl'] = None", "import of moderngl halted; None in sys.modules"),
        ("import sys; sys.path.insert(0, {folder!r})", "a library of it is broken"),
    ],
)
def test_no_moderngl(tmp_path, before, why):
    (tmp_path / "moderngl.py").write_text("raise OSError('a library of it is broken')")
    assert reported_error(before.format(folder=str(tmp_path))) == (
        f"moderngl, which comes with the extension, could not be loaded ({why}): install the extension again"
    )


@pytest.mark.parametrize("version", ["5.9.0", "6.0.0", "unknown"])
def test_a_moderngl_that_another_add_on_has_brought(tmp_path, version):
    """A copy of the real one with another version number is imported before ours."""
    copy = shutil.copytree(Path(moderngl.__file__).parent, tmp_path / "moderngl")
    text = (copy / "__init__.py").read_text("utf-8")
    changed_text = re.sub(r'^__version__ = ".*"$', f'__version__ = "{version}"', text, flags=re.M)
    assert changed_text != text
    (copy / "__init__.py").write_text(changed_text, "utf-8")
    assert reported_error(PYTHONPATH=tmp_path) == (
        f"Another add-on has brought moderngl {version} ({copy / '__init__.py'}), and this engine needs 5.10 or a "
        "later 5: disable that add-on and start Blender again"
    )


def test_the_bundled_moderngl_versions_are_supported():
    for wheels in project.WHEELS.values():
        (version,) = (package.partition("==")[2] for package in wheels["packages"] if package.startswith("moderngl="))
        assert OLDEST <= tuple(map(int, version.split(".")))[:2] < NEXT_MAJOR


@pytest.fixture
def at_pass(monkeypatch):
    """at_pass(number, action): calls action(loop) in the render thread, before it draws the number-th pass from now."""

    def at_pass(number, action) -> None:
        step, indices = RenderLoop.step, iter(range(number))

        def step_with_action(loop: RenderLoop, client: object, job: Job) -> None:
            if next(indices, None) == number - 1:
                action(loop)
            step(loop, client, job)

        monkeypatch.setattr(RenderLoop, "step", step_with_action)

    return at_pass


def function_address(loop: RenderLoop, name: str) -> int:
    """The address of one of OpenGL's functions."""
    return loop.device.gl.mglo._context.load(name)


def lost(loop: RenderLoop) -> None:
    """Lose the context as drivers do: from then on nothing is drawn, without an error."""
    ctypes.CFUNCTYPE(ctypes.c_uint)(function_address(loop, "eglReleaseThread"))()


def killed(_loop: RenderLoop) -> None:
    raise SystemExit  # as Python ends threads


@ON_LINUX
def test_context_lost_while_a_picture_is_read(worker, monkeypatch):
    """Undefined memory is not returned as a picture."""
    images, calls = Renderer.images, iter(range(3))

    def lose_context_at_third_call(renderer: Renderer, passes: Collection[RenderPass]) -> dict[str, np.ndarray]:
        if next(calls, 3) == 2:
            ctypes.CFUNCTYPE(ctypes.c_uint)(renderer.device.gl.mglo._context.load("eglReleaseThread"))()
        return images(renderer, passes)

    monkeypatch.setattr(Renderer, "images", lose_context_at_third_call)
    job, pictures = worker.start(request(LONG), "client"), []
    while not job.finished:
        job.wait(1.0)
        pictures.append(job.picture())
    assert "taken OpenGL away" in job.error
    assert all(picture.color.min() >= 0.0 and picture.color.max() < 10.0 for picture in pictures if picture is not None)


@pytest.mark.parametrize(
    ("action", "sentence"),
    [
        (lost, "The graphics driver has taken OpenGL away, as it does when it resets the card: render again"),
        (killed, "The thread that draws has ended unexpectedly: render again"),
    ],
)
@pytest.mark.parametrize("number", [1, 2, 30])
@ON_LINUX
@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_context_lost_and_worker_killed(worker, at_pass, action, sentence, number):
    """Waiting jobs end with the error and keep their last picture; the next request is drawn completely."""
    done = worker.start(request(), "done")
    assert wait_for_end(done)
    waiting = [worker.start(request(LONG), client) for client in ("one", "other")]
    assert all(wait_for_picture(job) for job in waiting)
    at_pass(number, action)
    assert all(wait_for_end(job) for job in waiting)
    assert [job.error for job in (done, *waiting)] == ["", sentence, sentence]
    assert all(np.isfinite(job.picture().color).all() for job in waiting)
    again = worker.start(request(), "one")
    assert wait_for_end(again)
    assert again.error == ""
    assert np.array_equal(again.picture().color, done.picture().color)


def test_a_broken_shader(worker, shaders):  # noqa: F811 (a fixture)
    edit(shaders / "passes/film/shade.frag", "void main() {", "void main() {\n    nonsense;")
    job = worker.start(request(), "client")
    assert wait_for_end(job)
    assert re.fullmatch(
        r"The picture could not be drawn: the shader .+ does not compile: shade\.frag, line \d+: .*nonsense.*",
        job.error,
    )


def test_a_picture_beyond_the_drivers_limit(worker, device):
    max_size = device.texture_size
    job = worker.start(request(size=(max_size + 1, 8)), "client")
    assert wait_for_end(job)
    assert job.error == (
        f"The picture could not be drawn: {max_size + 1}×8 pixels are more than the {max_size}×{max_size} "
        "that this OpenGL can draw at once"
    )


@pytest.mark.alone
@pytest.mark.parametrize("is_upright", [False, True])
def test_the_widest_picture(worker, device, is_upright):
    """As wide or as high as the driver's limit, it is drawn."""
    max_size = device.texture_size
    job = worker.start(request(size=(8, max_size) if is_upright else (max_size, 8)), "client")
    assert wait_for_end(job)
    assert job.error == ""
    assert np.isfinite(job.picture().color).all()


@pytest.mark.alone
def test_out_of_graphics_memory(worker, device, monkeypatch):
    """The software driver's textures are limited to 2 GB; with a graphics card its memory would have to be full.

    Free memory is reported as unknown, so that no estimate refuses the picture before.
    """
    monkeypatch.setattr(memory_estimate, "free", lambda gl: None)
    if "llvmpipe" not in device.name:
        pytest.skip("only the software driver's limit is known")
    small = worker.start(request(LONG), "small")
    assert wait_for_picture(small)
    job = worker.start(request(size=(device.texture_size, device.texture_size // 2)), "large")
    assert wait_for_end(job, 120.0)
    assert job.error == (
        "The picture could not be drawn: the graphics memory is too small for it; "
        "a smaller picture or smaller images take less"
    )
    assert not small.finished
    again = worker.start(request(), "large")
    assert wait_for_end(again)
    assert again.error == ""


def test_an_opengl_error(worker, at_pass):
    """Drivers only record it and go on: without a check the picture would be wrong and no error shown."""
    at_pass(5, lambda loop: ctypes.CFUNCTYPE(None, ctypes.c_uint)(function_address(loop, "glEnable"))(0xFFFF))
    job = worker.start(request(), "client")
    assert wait_for_end(job)
    assert job.error == "The picture could not be drawn: the graphics driver refuses it (GL_INVALID_ENUM)"


def test_an_atlas_beyond_the_limit():
    """An atlas is drawn in portions, see test_atlas.py; only a single map may be wider than any texture."""
    settings = replace(SMALL_SHADOW_MAPS, quality=replace(SMALL_SHADOW_MAPS.quality, map_size=100_000))
    assert beyond_limits(settings) == ("Map Size cannot be 100,000: 4,096 is used instead.",)
