# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist reads where OpenGL is not there, breaks or is asked for too much; and drawing goes on afterwards."""

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

#: Asks twice, in an interpreter of its own, and prints both errors.
ASK = """
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

ON_LINUX = pytest.mark.skipif(sys.platform != "linux", reason="takes OpenGL away as it is done on Linux")


def complaint(before: str = "", **environment: object) -> str:
    """What two clients are both told, after the lines `before`."""
    asked = subprocess.run(
        [sys.executable, "-c", before + ASK],
        cwd=project.ROOT,
        env=os.environ | {name: str(value) for name, value in environment.items()},
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert asked.returncode == 0, asked.stderr
    assert "Traceback" not in asked.stderr
    first, second = asked.stdout.splitlines()
    assert first == second
    return first


def says_no_opengl(error: str) -> bool:
    """What is in the brackets comes from elsewhere."""
    return re.sub(r"\(.+\)", "(…)", error) == (
        "OpenGL 4.1 could not be opened (…): "
        "install the graphics card's driver, or Mesa's EGL libraries for rendering without a card"
    )


@ON_LINUX
def test_no_egl(tmp_path):
    """A library of that name that is none goes before the real one."""
    for name in ("libEGL.so", "libEGL.so.1"):
        (tmp_path / name).write_text("none")
    assert says_no_opengl(complaint(LD_LIBRARY_PATH=tmp_path))


@ON_LINUX
def test_no_driver():
    assert says_no_opengl(complaint(__EGL_VENDOR_LIBRARY_FILENAMES="/none", LIBGL_DRIVERS_PATH="/none"))


def test_an_opengl_that_is_too_old(opened_device):
    if "llvmpipe" not in opened_device.name:
        pytest.skip("only Mesa can be told to be older than it is")
    assert says_no_opengl(complaint(MESA_GL_VERSION_OVERRIDE="3.3"))


@pytest.mark.parametrize(
    ("before", "why"),
    [
        ("import sys; sys.modules['moderngl'] = None", "import of moderngl halted; None in sys.modules"),
        ("import sys; sys.path.insert(0, {folder!r})", "a library of it is broken"),
    ],
)
def test_no_moderngl(tmp_path, before, why):
    (tmp_path / "moderngl.py").write_text("raise OSError('a library of it is broken')")
    assert complaint(before.format(folder=str(tmp_path))) == (
        f"moderngl, which comes with the extension, could not be loaded ({why}): install the extension again"
    )


@pytest.mark.parametrize("version", ["5.9.0", "6.0.0", "unknown"])
def test_a_moderngl_that_another_add_on_has_brought(tmp_path, version):
    """The real one, told to be of another version, goes before ours."""
    theirs = shutil.copytree(Path(moderngl.__file__).parent, tmp_path / "moderngl")
    text = (theirs / "__init__.py").read_text("utf-8")
    changed = re.sub(r'^__version__ = ".*"$', f'__version__ = "{version}"', text, flags=re.M)
    assert changed != text
    (theirs / "__init__.py").write_text(changed, "utf-8")
    assert complaint(PYTHONPATH=tmp_path) == (
        f"Another add-on has brought moderngl {version} ({theirs / '__init__.py'}), and this engine needs 5.10 or a "
        "later 5: disable that add-on and start Blender again"
    )


def test_the_moderngls_that_the_extension_brings_are_among_those_it_can_use():
    for carried in project.WHEELS.values():
        (version,) = (package.partition("==")[2] for package in carried["packages"] if package.startswith("moderngl="))
        assert OLDEST <= tuple(map(int, version.split(".")))[:2] < NEXT_MAJOR


@pytest.fixture
def at_pass(monkeypatch):
    """at_pass(number, do): do(loop) before the number-th pass from now on is drawn, in the worker's thread."""

    def at_pass(number, do) -> None:
        step, left = RenderLoop.step, iter(range(number))

        def step_or_do(loop: RenderLoop, client: object, job: Job) -> None:
            if next(left, None) == number - 1:
                do(loop)
            step(loop, client, job)

        monkeypatch.setattr(RenderLoop, "step", step_or_do)

    return at_pass


def load(loop: RenderLoop, name: str) -> int:
    """The address of one of OpenGL's functions."""
    return loop.device.gl.mglo._context.load(name)


def lost(loop: RenderLoop) -> None:
    """As drivers do: from then on nothing is drawn, and nothing is said about it."""
    ctypes.CFUNCTYPE(ctypes.c_uint)(load(loop, "eglReleaseThread"))()


def killed(_studio: RenderLoop) -> None:
    raise SystemExit  # as Python ends threads


@ON_LINUX
def test_context_lost_while_a_picture_is_read(worker, monkeypatch):
    """What was in memory before is no picture."""
    images, count = Renderer.images, iter(range(3))

    def images_or_loss(renderer: Renderer, wanted: Collection[RenderPass]) -> dict[str, np.ndarray]:
        if next(count, 3) == 2:
            ctypes.CFUNCTYPE(ctypes.c_uint)(renderer.device.gl.mglo._context.load("eglReleaseThread"))()
        return images(renderer, wanted)

    monkeypatch.setattr(Renderer, "images", images_or_loss)
    job, pictures = worker.start(request(LONG), "client"), []
    while not job.finished:
        job.wait(1.0)
        pictures.append(job.picture())
    assert "taken OpenGL away" in job.error
    assert all(picture.color.min() >= 0.0 and picture.color.max() < 10.0 for picture in pictures if picture is not None)


@pytest.mark.parametrize(
    ("do", "sentence"),
    [
        (lost, "The graphics driver has taken OpenGL away, as it does when it resets the card: render again"),
        (killed, "The thread that draws has ended unexpectedly: render again"),
    ],
)
@pytest.mark.parametrize("number", [1, 2, 30])
@ON_LINUX
@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_context_lost_and_worker_killed(worker, at_pass, do, sentence, number):
    """All who wait are told, and keep the picture that they have; who asks next has a whole one."""
    done = worker.start(request(), "done")
    assert wait_for_end(done)
    waiting = [worker.start(request(LONG), client) for client in ("one", "other")]
    assert all(wait_for_picture(job) for job in waiting)
    at_pass(number, do)
    assert all(wait_for_end(job) for job in waiting)
    assert [job.error for job in (done, *waiting)] == ["", sentence, sentence]
    assert all(np.isfinite(job.picture().color).all() for job in waiting)
    again = worker.start(request(), "one")
    assert wait_for_end(again)
    assert again.error == ""
    assert np.array_equal(again.picture().color, done.picture().color)


def test_a_shader_that_is_broken(worker, shaders):  # noqa: F811 (a fixture)
    edit(shaders / "passes/film/shade.frag", "void main() {", "void main() {\n    nonsense;")
    job = worker.start(request(), "client")
    assert wait_for_end(job)
    assert re.fullmatch(
        r"The picture could not be drawn: the shader .+ does not compile: shade\.frag, line \d+: .*nonsense.*",
        job.error,
    )


def test_a_picture_beyond_the_drivers_limit(worker, device):
    most = device.texture_size
    job = worker.start(request(size=(most + 1, 8)), "client")
    assert wait_for_end(job)
    assert job.error == (
        f"The picture could not be drawn: {most + 1}×8 pixels are more than the {most}×{most} "
        "that this OpenGL can draw at once"
    )


@pytest.mark.alone
@pytest.mark.parametrize("turned", [False, True])
def test_the_widest_picture(worker, device, turned):
    """Up to the limit, all are drawn."""
    most = device.texture_size
    job = worker.start(request(size=(8, most) if turned else (most, 8)), "client")
    assert wait_for_end(job)
    assert job.error == ""
    assert np.isfinite(job.picture().color).all()


@pytest.mark.alone
def test_out_of_graphics_memory(worker, device, monkeypatch):
    """Of the software driver, no texture has more than 2 GB; a card's memory would have to be full.

    Where the system does not say how much is free, nothing is estimated before.
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


def test_what_opengl_refuses(worker, at_pass):
    """Drivers only note it, and go on: the picture would be wrong without a word."""
    at_pass(5, lambda loop: ctypes.CFUNCTYPE(None, ctypes.c_uint)(load(loop, "glEnable"))(0xFFFF))
    job = worker.start(request(), "client")
    assert wait_for_end(job)
    assert job.error == "The picture could not be drawn: the graphics driver refuses it (GL_INVALID_ENUM)"


def test_an_atlas_beyond_the_limit():
    """It is drawn in portions, see test_atlas.py; only a map by itself may be wider than any texture."""
    asked = replace(SMALL_SHADOW_MAPS, quality=replace(SMALL_SHADOW_MAPS.quality, map_size=100_000))
    assert beyond_limits(asked) == ("Map Size cannot be 100,000: 4,096 is used instead.",)
