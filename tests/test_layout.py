# SPDX-License-Identifier: GPL-3.0-or-later
"""What numpy writes, GLSL reads: records, arrays and directions through a shader and back."""

import moderngl
import numpy as np
import pytest

from ism_addon.gpu.layout import (
    LIGHT,
    WIDTH,
    Record,
    directions_from_octahedron,
    lines_for,
    octahedron_from_directions,
    upload_array,
)
from ism_addon.gpu.program import FOLDER, head

ODD = Record("Odd", one="float", two="vec2", three="vec3", count="int", four="vec4")


def run(device, declarations: str, expression: str, count: int, uniforms: dict) -> np.ndarray:
    """(count,4) of an expression in `row`, by transform feedback."""
    program = device.gl.program(
        vertex_shader=f"{head((), {})}{declarations}\nout vec4 told;\n"
        f"void main() {{ int row = gl_VertexID; told = {expression}; }}",
        varyings=["told"],
    )
    for unit, (name, texture) in enumerate(uniforms.items()):
        texture.use(unit)
        program[name].value = unit
    device.gl.simple_framebuffer((1, 1)).use()  # without one, OpenGL draws nothing, nor feeds back
    device.gl.simple_framebuffer((1, 1)).use()  # whatever an earlier test drew into may be gone
    buffer = device.gl.buffer(reserve=16 * count)
    device.gl.vertex_array(program, []).transform(buffer, moderngl.POINTS, vertices=count)
    return np.frombuffer(buffer.read(), "f4").reshape(count, 4)


@pytest.mark.parametrize("record", [ODD, LIGHT])
def test_every_member_of_every_row_arrives(device, record):
    rows = record.rows + 3  # into the texture's second line
    table = np.zeros(rows, record.dtype)
    random = np.random.default_rng(0)
    for name in record.members:
        table[name] = random.integers(-1000, 1000, table[name].shape)
    texture = record.upload(device.gl, table)
    for name, kind in record.members.items():
        padding = {"float": ", 0, 0, 0", "int": ", 0, 0, 0", "vec2": ", 0, 0", "vec3": ", 0", "vec4": ""}[kind]
        told = run(
            device,
            f"{record.glsl()}\nuniform sampler2D table;",
            f"vec4(fetch_{record.name}(table, row).{name}{padding})",
            rows,
            {"table": texture},
        )
        expected = table[name].reshape(rows, -1)
        assert np.array_equal(told[:, : expected.shape[1]], expected)


def test_a_table_may_be_empty(device):
    assert LIGHT.upload(device.gl, np.zeros(0, LIGHT.dtype)).size[1] > 0


@pytest.mark.parametrize("of_line", [1, 1000, WIDTH])
def test_lines_hold_all_and_are_never_a_power_of_two(of_line):
    """Else scenes of other sizes are other shaders to Mesa's software driver."""
    for count in (*range(20), *range(WIDTH - 2, WIDTH + 3), 10**7):
        lines = lines_for(count, of_line)
        assert count <= lines * of_line
        assert lines <= max(count / of_line + 2.0, 3)
        assert lines & (lines - 1)


@pytest.mark.parametrize("count", [0, 1, WIDTH, WIDTH + 1, 3 * WIDTH - 1])
@pytest.mark.parametrize("components", [1, 2, 3])
def test_arrays_of_any_length_arrive(device, count, components):
    array = np.arange(count * components, dtype=np.float32).reshape(count, components)
    texture = upload_array(device.gl, array, "f4")
    told = np.frombuffer(texture.read(), "f4").reshape(-1, components)
    assert np.array_equal(told[:count], array)


def test_directions_survive_the_octahedron():
    random = np.random.default_rng(0).normal(size=(10_000, 3))
    directions = np.concatenate([random / np.linalg.norm(random, axis=1)[:, None], np.eye(3), -np.eye(3)])
    points = octahedron_from_directions(directions)
    assert np.abs(points).max() <= 1.0
    assert directions_from_octahedron(points) == pytest.approx(directions, abs=1e-12)


def test_python_and_glsl_fold_directions_alike(device):
    random = np.random.default_rng(1).normal(size=(1000, 3)).astype("f4")
    directions = random / np.linalg.norm(random, axis=1)[:, None]
    library = (FOLDER / "lib" / "octahedron.glsl").read_text()
    told = run(
        device,
        f"{library}\nuniform sampler2D table;",
        "vec4(octahedron_from_direction(texelFetch(table, ivec2(row, 0), 0).xyz), 0, 0)",
        1000,
        {"table": upload_array(device.gl, directions, "f4")},
    )
    assert told[:, :2] == pytest.approx(octahedron_from_directions(directions.astype(float)), abs=1e-6)
