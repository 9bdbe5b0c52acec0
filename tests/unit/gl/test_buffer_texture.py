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


def rows_of(device, table, count: int) -> np.ndarray:
    """(count * row_texels,4) texels that a shader fetches of a table."""
    end = (table.first_row + count) * table.row_texels
    if not end:
        return np.zeros((0, 4))
    return fetched(device, table.buffer, "u4", end)[table.first_row * table.row_texels :]


def test_tables_in_one_buffer_keep_their_rows_while_others_grow_and_change(device):
    random, records, tables, expected = np.random.default_rng(0), device.scene_records(), {}, {}
    row_texels = {"lights": 7, "nodes": 2, "casters": 5, "texels": 3}
    order = [*("lights", "nodes", "texels", "casters"), *("nodes", "lights", "casters", "texels", "nodes")]
    for step, name in enumerate(order):
        count = int(random.integers(1, 40)) if step else 0  # the first is empty
        expected[name] = random.integers(0, 1 << 20, (count * row_texels[name], 4)).astype(np.uint32)
        tables[name] = records.write(name, expected[name], row_texels[name])
        for each, table in tables.items():
            count = len(expected[each]) // row_texels[each]
            assert np.array_equal(rows_of(device, table, count), expected[each]), (step, each)
    assert len({id(table.buffer) for table in tables.values()}) == 1


def test_a_table_that_fits_is_written_in_place(device):
    records, rows = device.scene_records(), np.arange(40, dtype=np.uint32).reshape(10, 4)
    first, second = records.write("first", rows, 1), records.write("second", rows, 2)
    buffer = second.buffer
    assert records.write("second", rows[:4] + 1, 2) is second
    assert first.buffer is second.buffer is buffer
    assert np.array_equal(rows_of(device, second, 5), np.concatenate([rows[:4] + 1, rows[4:]]))
    assert np.array_equal(rows_of(device, first, 10), rows)


def test_tables_that_nothing_refers_to_take_no_room(device):
    records, rows = device.scene_records(), np.ones((1000, 4), np.uint32)
    tables = [records.write("first", rows, 1)]
    tables.append(records.write("second", rows[:10], 1))
    assert tables[1].buffer.count >= 1010
    del tables[0]
    tables.append(records.write("third", rows[:10], 1))
    assert tables[0].buffer is tables[1].buffer
    assert tables[1].buffer.count < 1000


def test_too_many_rows_leave_the_other_tables_as_they_were(device, monkeypatch):
    records, rows = device.scene_records(), np.arange(40, dtype=np.uint32).reshape(10, 4)
    first, second = records.write("first", rows, 1), records.write("second", rows, 2)
    monkeypatch.setattr(device.buffer_textures, "max_rows", 30)
    with pytest.raises(ValueError, match="34 rows are more than the 30 that this OpenGL can fetch"):
        records.write("second", np.zeros((24, 4), np.uint32), 2)
    for table, count in ((first, 10), (second, 5)):
        assert np.array_equal(rows_of(device, table, count), rows)


def test_a_program_reads_a_table_from_its_first_row(device):
    """The uniform of its name follows the table when it moves."""
    records, rows = device.scene_records(), np.arange(48, dtype=np.uint32).reshape(12, 4)
    lights = records.write("lights", rows, 3)
    program = device.gl.program(
        vertex_shader="#version 410 core\nuniform usamplerBuffer scene_records;\nuniform int lights;\n"
        "out vec4 result;\nvoid main() { result = vec4(texelFetch(scene_records, 3 * (lights + gl_VertexID) + 1)); }",
        varyings=["result"],
    )
    for count in (12, 24, 36):
        bind(program, lights=lights)
        device.gl.simple_framebuffer((1, 1)).use()
        buffer = device.gl.buffer(reserve=4 * 16)
        device.gl.vertex_array(program, []).transform(buffer, moderngl.POINTS, vertices=4)
        assert np.array_equal(np.frombuffer(buffer.read(), "f4").reshape(4, 4), rows[1::3])
        other = records.write("other", np.zeros((count, 4), np.uint32), 1)
        assert lights.buffer is other.buffer
        assert lights.first_row == count // 3
