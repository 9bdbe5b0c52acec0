# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures for tests of several layers: an OpenGL device, a render thread, and a check of all compiled shaders."""

import threading

import pytest

from tests.tools.glslang import ReferenceCompiler


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--rounds", type=int, default=100, help="renders, and updates of viewports, in a row (%(default)s)"
    )
    parser.addoption("--examples", type=int, default=100, help="random pictures that are drawn (%(default)s)")
    parser.addoption("--frames", type=int, default=8, help="frames of animations, compared with Cycles (%(default)s)")


@pytest.fixture(scope="session")
def watching_compiler():
    compiler = ReferenceCompiler()
    with compiler.watching():
        yield compiler


@pytest.fixture(autouse=True)
def reference_compiler(watching_compiler):
    """Fails a test that compiled a shader which the Khronos reference compiler rejects, whatever the driver accepts."""
    yield watching_compiler
    watching_compiler.check()


@pytest.fixture(scope="session")
def opened_device():
    # Imported here, so that tests of pure modules run without OpenGL.
    from ism_addon.gpu.gl.context import open_device

    device = open_device()
    yield device
    device.close()


@pytest.fixture
def device(opened_device):
    """A Device, current in this thread. A test that leaves an OpenGL error behind fails."""
    with opened_device.gl as gl:
        assert gl.error == "GL_NO_ERROR", "an earlier use of this context left an error behind"
        yield opened_device
        assert gl.error == "GL_NO_ERROR"
        opened_device.free_released()


@pytest.fixture
def worker():
    """A RenderThread. Its thread must have ended when the test is over."""
    from ism_addon.gpu.jobs.render_thread import RenderThread

    render_thread = RenderThread()
    yield render_thread
    render_thread.stop()
    assert not [thread for thread in threading.enumerate() if thread.name == "ISM renderer"]
