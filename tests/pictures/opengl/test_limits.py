# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures with the limits that OpenGL 4.1 guarantees, and the errors of those that exceed them."""

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
SETTINGS = {method: replace(Settings(), shadow=Shadow(method=method)) for method in Method}


@pytest.fixture(scope="module")
def opened() -> Iterator[tuple[Device, LimitedContext]]:
    """A device with these limits, and the wrapper of its context, which checks them."""
    with pytest.MonkeyPatch.context() as patch:
        contexts = wrap_contexts(patch, lambda context: LimitedContext(context, BYTES))
        device = open_device()
    yield device, contexts[0]
    device.close()


@pytest.fixture
def limited(opened: tuple[Device, LimitedContext]) -> Iterator[Device]:
    """The device, current in this thread. The test fails if it exceeds what OpenGL 4.1 guarantees."""
    device, context = opened
    with device.gl as gl:
        yield device
        assert gl.error == "GL_NO_ERROR"
        assert context.faults == []


def test_the_limits_are_reported_and_the_frame_uniforms_fit(limited):
    info = limited.gl.info
    expected = LIMITS | {"GL_MAX_VIEWPORT_DIMS": (LIMITS["GL_MAX_VIEWPORT_DIMS"],) * 2}
    assert {name: info[name] for name in expected} == expected
    assert limited.texture_size == LIMITS["GL_MAX_TEXTURE_SIZE"]
    assert frame_uniforms.DTYPE.itemsize <= LIMITS["GL_MAX_UNIFORM_BLOCK_SIZE"]


@pytest.mark.parametrize("settings", [SMALL_SETTINGS, SMALL_SHADOW_MAPS], ids=list(Method))
@pytest.mark.parametrize("name", SMALL)
def test_pictures_are_the_same(device, limited, name, settings):
    """As without limits. Occlusion, a pixel filter and several samples make all passes draw."""
    scene, view = SMALL[name](48, 32)
    view = replace(view, filter_width=1.5)
    settings = replace(with_quality(settings, samples=4), ssao=SSAO(enabled=True))
    with limited.gl:
        color = draw(limited, scene, view, settings).color
    with device.gl:
        assert np.array_equal(color, draw(device, scene, view, settings).color)


@pytest.mark.parametrize("method", Method)
def test_a_final_picture_can_be_drawn(limited, method):
    """Its first sample, with the default settings."""
    scene, view = box_over_plane(640, 360)
    assert np.isfinite(draw(limited, scene, view, SETTINGS[method], last=0).color).all()


def test_a_scene_of_more_triangles_is_refused_with_a_sentence(monkeypatch, worker):
    """A triangle has three rows of normals in a buffer texture. The next picture is drawn."""
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


def test_exceeding_a_limit_is_recorded(opened, limited):
    """This driver grants more than is guaranteed; others may not."""
    context = opened[1]
    texture = limited.gl.texture((1, 1), 4)
    texture.use(LIMITS["GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS"] - 1)
    assert context.faults == []
    texture.use(LIMITS["GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS"])
    assert context.faults == ["texture units: 81 are more than GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS, 80"]
    context.faults.clear()


def test_rows_beyond_the_limit_read_as_zero(limited):
    """A buffer texture that is longer than allowed has no data beyond the limit."""
    limit = LIMITS["GL_MAX_TEXTURE_BUFFER_SIZE"]
    rows = limited.buffer_textures
    rows.max_rows, allowed = 2 * limit, rows.max_rows
    table = limited.buffer_from(np.ones((limit + 1, 1), np.float32))
    rows.max_rows = allowed
    program = limited.gl.program(
        vertex_shader="#version 410 core\nuniform samplerBuffer table;\nout vec2 fetched;\n"
        f"void main() {{ fetched = vec2(texelFetch(table, {limit - 1}).x, texelFetch(table, {limit}).x); }}",
        varyings=["fetched"],
    )
    bind(program, table=table)
    limited.gl.simple_framebuffer((1, 1)).use()
    buffer = limited.gl.buffer(reserve=8)
    limited.gl.vertex_array(program, []).transform(buffer, vertices=1)
    assert np.frombuffer(buffer.read(), np.float32).tolist() == [1.0, 0.0]
