# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures by an OpenGL that can no more than version 4.1 guarantees, and what is said of those that it cannot draw."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from ism_addon.gpu.gl import frame_uniforms
from ism_addon.gpu.gl.buffer_texture import FORMATS
from ism_addon.gpu.gl.context import Device, open_device
from ism_addon.gpu.gl.shader_compiler import bind
from ism_addon.gpu.jobs.job import Request
from ism_addon.settings import SSAO, Method, Settings, Shadow
from tests.scenes.small import SMALL, box_over_plane, sphere
from tests.support.gl_limits import LIMITS, LimitedContext
from tests.support.gl_wrapper import wrap_contexts
from tests.support.jobs import wait_for_end
from tests.support.small_scenes import SMALL_SETTINGS, SMALL_SHADOW_MAPS, draw, make_scene, with_quality

BYTES = {format: np.dtype(dtype).itemsize * components for (dtype, components), format in FORMATS.items()}
BOTH = {method: replace(Settings(), shadow=Shadow(method=method)) for method in Method}


@pytest.fixture(scope="module")
def opened() -> Iterator[tuple[Device, LimitedContext]]:
    """A device of such an OpenGL, which draws all pictures here, and what stands before its context."""
    with pytest.MonkeyPatch.context() as patch:
        contexts = wrap_contexts(patch, lambda context: LimitedContext(context, BYTES))
        device = open_device()
    yield device, contexts[0]
    device.close()


@pytest.fixture
def limited(opened: tuple[Device, LimitedContext]) -> Iterator[Device]:
    """The device, current in this thread. A test that asks for more than OpenGL 4.1 guarantees has failed."""
    device, context = opened
    with device.gl as gl:
        yield device
        assert gl.error == "GL_NO_ERROR"
        assert context.faults == []


def test_the_limits_are_told_and_the_frames_block_is_below(limited):
    told = limited.gl.info
    most = LIMITS | {"GL_MAX_VIEWPORT_DIMS": (LIMITS["GL_MAX_VIEWPORT_DIMS"],) * 2}
    assert {name: told[name] for name in most} == most
    assert limited.texture_size == LIMITS["GL_MAX_TEXTURE_SIZE"]
    assert frame_uniforms.DTYPE.itemsize <= LIMITS["GL_MAX_UNIFORM_BLOCK_SIZE"]


@pytest.mark.parametrize("settings", [SMALL_SETTINGS, SMALL_SHADOW_MAPS], ids=list(Method))
@pytest.mark.parametrize("name", SMALL)
def test_pictures_are_the_same(device, limited, name, settings):
    """As without limits; with all that is drawn in some picture: creases, a filter, several samples."""
    scene, view = SMALL[name](48, 32)
    view = replace(view, filter_width=1.5)
    settings = replace(with_quality(settings, samples=4), ssao=SSAO(enabled=True))
    with limited.gl:
        found = draw(limited, scene, view, settings).color
    with device.gl:
        assert np.array_equal(found, draw(device, scene, view, settings).color)


@pytest.mark.parametrize("method", Method)
def test_a_final_picture_is_begun(limited, method):
    """With the settings that Blender starts with."""
    scene, view = box_over_plane(640, 360)
    assert np.isfinite(draw(limited, scene, view, BOTH[method], last=0).color).all()


def test_a_scene_of_more_triangles_is_refused_with_a_sentence(monkeypatch, worker):
    """Three rows of normals each; and the next picture is drawn."""
    wrap_contexts(monkeypatch, lambda context: LimitedContext(context, BYTES))
    _, view = box_over_plane(24, 16)
    large = make_scene([sphere((0.0, 0.0, 0.5), 0.5, 200, 100)])
    triangles = sum(len(mesh.triangles) for mesh in large.meshes)
    job = worker.start(Request(large, view, SMALL_SETTINGS), "script")
    assert wait_for_end(job)
    assert job.error == (
        f"The picture could not be drawn: the meshes have {triangles:,} triangles, of which this OpenGL can draw "
        "21,845 (instances of a mesh count once)"
    )
    job = worker.start(Request(*box_over_plane(24, 16), SMALL_SETTINGS), "script")
    assert wait_for_end(job)
    assert (job.error, job.samples_done) == ("", 1)


def test_what_is_beyond_a_limit_is_noted(opened, limited):
    """Who asks for more than is guaranteed gets it from this driver, and would not from others."""
    context = opened[1]
    texture = limited.gl.texture((1, 1), 4)
    texture.use(LIMITS["GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS"] - 1)
    assert context.faults == []
    texture.use(LIMITS["GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS"])
    assert context.faults == ["texture units: 81 are more than GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS, 80"]
    context.faults.clear()


def test_rows_beyond_the_limit_are_not_there(limited):
    """Whoever made room for more than is allowed would read nothing from it."""
    most = LIMITS["GL_MAX_TEXTURE_BUFFER_SIZE"]
    rows = limited.buffer_textures
    rows.max_rows, allowed = 2 * most, rows.max_rows
    table = limited.buffer_from(np.ones((most + 1, 1), np.float32))
    rows.max_rows = allowed
    program = limited.gl.program(
        vertex_shader="#version 410 core\nuniform samplerBuffer table;\nout vec2 told;\n"
        f"void main() {{ told = vec2(texelFetch(table, {most - 1}).x, texelFetch(table, {most}).x); }}",
        varyings=["told"],
    )
    bind(program, table=table)
    limited.gl.simple_framebuffer((1, 1)).use()
    buffer = limited.gl.buffer(reserve=8)
    limited.gl.vertex_array(program, []).transform(buffer, vertices=1)
    assert np.frombuffer(buffer.read(), np.float32).tolist() == [1.0, 0.0]
