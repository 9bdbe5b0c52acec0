# SPDX-License-Identifier: GPL-3.0-or-later
"""Buffer textures: rows written at any offset are fetched by index; unreferenced textures are freed."""

import ctypes
from threading import Thread

import moderngl
import numpy as np
import pytest

from ism_addon.gpu.gl.buffer_texture import FORMATS
from ism_addon.gpu.gl.shader_compiler import bind

SAMPLERS = {"f": "samplerBuffer", "u": "usamplerBuffer", "i": "isamplerBuffer"}


def fetched(device, array, dtype: str, count: int) -> np.ndarray:
    """(count,4) rows as a shader fetches them, in another texture unit than the one they were created in."""
    program = device.gl.program(
        vertex_shader=f"#version 410 core\nuniform {SAMPLERS[dtype[0]]} table;\nout vec4 result;\n"
        "void main() { result = vec4(texelFetch(table, gl_VertexID)); }",
        varyings=["result"],
    )
    bind(program, table=array)
    device.gl.simple_framebuffer((1, 1)).use()  # without one, OpenGL neither draws nor captures
    buffer = device.gl.buffer(reserve=16 * count)
    device.gl.vertex_array(program, []).transform(buffer, moderngl.POINTS, vertices=count)
    return np.frombuffer(buffer.read(), "f4").reshape(count, 4)


@pytest.mark.parametrize("dtype, components", FORMATS)
@pytest.mark.parametrize("count", [1, 2, 1000])
def test_rows_arrive(device, dtype, components, count):
    rows = np.random.default_rng(count).integers(0, 1 << 15, (count, components)).astype(dtype)
    assert np.array_equal(fetched(device, device.buffer_from(rows), dtype, count)[:, :components], rows)


def test_rows_are_written_anywhere(device):
    rows = np.arange(4 * 50, dtype=np.float32).reshape(50, 4)
    array = device.new_buffer(50, 4, "f4")
    for part in (slice(17, 50), slice(0, 3), slice(3, 17), slice(5, 5)):
        array.write(rows[part], part.start)
    assert np.array_equal(fetched(device, array, "f4", 50), rows)


@pytest.mark.parametrize("row", [4, 16])
def test_buffer_sizes_are_of_one_shader_variant(device, row):
    """Otherwise Mesa's software driver compiles shaders again for scenes of other sizes."""
    for count in (*range(20), 255, 256, 257, 4096):
        size = device.new_buffer(count, row // 4, "f4").bytes
        assert row * count <= size <= row * (count + 1) + 256
        assert size & (size - 1)
        assert size >> 8 & 255


def test_more_rows_than_can_be_fetched_are_refused_with_a_clear_error(device):
    limit = device.buffer_textures.max_rows
    with pytest.raises(ValueError, match=f"{limit + 1:,} rows are more than the {limit:,} that this OpenGL can fetch"):
        device.new_buffer(limit + 1, 1, "f4")


def test_a_growing_buffer_may_be_filled_to_the_row_limit(device, monkeypatch):
    monkeypatch.setattr(device.buffer_textures, "max_rows", 100)
    rows, growing = np.arange(100, dtype=np.float32).reshape(100, 1), device.growing_buffer(1, "f4")
    for part in (rows[:80], rows[80:90], rows[90:]):
        growing.reserve(len(part))
        growing.append(part)
    assert np.array_equal(fetched(device, growing.texture, "f4", 100)[:, :1], rows)


def test_a_texture_released_in_another_thread_is_freed_in_this_one(device):
    is_texture = ctypes.CFUNCTYPE(ctypes.c_ubyte, ctypes.c_uint)(device.gl.mglo._context.load("glIsTexture"))
    references = [device.new_buffer(10, 4, "f4")]
    name = references[0]._texture
    thread = Thread(target=references.clear)
    thread.start()
    thread.join()
    assert is_texture(name)
    device.free_released()
    assert not is_texture(name)


def test_a_growing_buffer(device):
    """Rows are appended in place while they fit, then in a larger buffer; the previous buffer keeps its rows."""
    rows, growing, arrays = np.arange(4 * 100, dtype=np.float32).reshape(100, 4), device.growing_buffer(4, "f4"), []
    for first, end in ((0, 40), (40, 41), (41, 60), (60, 60), (60, 100)):
        growing.reserve(end - first)
        growing.append(rows[first:end])
        arrays.append(growing.texture)
        assert np.array_equal(fetched(device, growing.texture, "f4", end), rows[:end])
    assert arrays[1] is arrays[2] is arrays[3]
    assert len(set(map(id, arrays))) == 3
    assert np.array_equal(fetched(device, arrays[0], "f4", 40), rows[:40])
