# SPDX-License-Identifier: GPL-3.0-or-later
"""Records, arrays and directions that numpy writes are read by GLSL: through a shader and back."""

import moderngl
import numpy as np
import pytest

from ism_addon.gpu.gl.shader_compiler import FOLDER, bind, head
from ism_addon.gpu.gl.shader_records import (
    LIGHT,
    MEMBER_TYPES,
    Record,
    directions_from_octahedron,
    octahedron_from_directions,
)

ODD = Record("Odd", one="float", two="vec2", three="vec3", count="int", four="vec4", mask="uint")


#: Integers that a float32 cannot represent, and bit patterns of float32's infinities, NaNs and denormal numbers.
ODD_BITS = np.array(
    [*(0, 1, 2**24 + 1, 2**31 - 1, 2**31, 2**31 + 1, 2**32 - 1), *(0x7F800000, 0x7F800001, 0xFFC00001, 0x7FA00000, 5)],
    np.uint32,
)


def run(device, declarations: str, expression: str, count: int, uniforms: dict) -> np.ndarray:
    """(count,4) values of a GLSL expression in `row`, by transform feedback."""
    program = device.gl.program(
        vertex_shader=f"{head((), {})}{declarations}\nout vec4 result;\n"
        f"void main() {{ int row = gl_VertexID; result = {expression}; }}",
        varyings=["result"],
    )
    bind(program, **uniforms)
    device.gl.simple_framebuffer((1, 1)).use()  # without one, OpenGL neither draws nor captures
    device.gl.simple_framebuffer((1, 1)).use()  # an earlier test's framebuffer may have been freed
    buffer = device.gl.buffer(reserve=16 * count)
    device.gl.vertex_array(program, []).transform(buffer, moderngl.POINTS, vertices=count)
    return np.frombuffer(buffer.read(), "f4").reshape(count, 4)


@pytest.mark.parametrize("record", [ODD, LIGHT])
def test_every_member_of_every_row_arrives(device, record):
    rows = 1000
    table = np.zeros(rows, record.dtype)
    random = np.random.default_rng(0)
    for name in record.members:
        table[name] = random.integers(0 if record.members[name] == "uint" else -1000, 1000, table[name].shape)
    texture = record.upload(device, table)
    for name, type_ in record.members.items():
        fetched = run(
            device,
            f"{record.glsl()}\nuniform usamplerBuffer table;",
            f"vec4(fetch_{record.name}(table, row).{name}{', 0' * (4 - MEMBER_TYPES[type_].words)})",
            rows,
            {"table": texture},
        )
        expected = table[name].reshape(rows, -1)
        assert np.array_equal(fetched[:, : expected.shape[1]], expected)


def test_integers_arrive_bit_for_bit(device):
    """In a fragment shader. As floats they would be exact up to 2^24 only, and NaN bits could change."""
    record = Record("Whole", before="float", signed="int", mask="uint", after="vec2")
    table = np.zeros(len(ODD_BITS), record.dtype)
    table["signed"], table["mask"] = ODD_BITS.view(np.int32), ODD_BITS
    table["before"], table["after"] = -1.5, (2.5, 1e-38)
    gl = device.gl
    program = gl.program(
        vertex_shader=head((), {}) + (FOLDER / "glsl/full_screen.vert").read_text(),
        fragment_shader=f"{head((record,), {})}uniform usamplerBuffer table;\n"
        "layout(location = 0) out uvec4 integers;\nlayout(location = 1) out vec4 floats;\nvoid main() {\n"
        "    Whole row = fetch_Whole(table, int(gl_FragCoord.x));\n"
        "    integers = uvec4(row.signed, row.mask, row.mask >> 31, row.signed < 0);\n"
        "    floats = vec4(row.before, row.after, 0.0);\n}\n",
    )
    bind(program, table=record.upload(device, table))
    integers, floats = (gl.texture((len(table), 1), 4, dtype=dtype) for dtype in ("u4", "f4"))
    gl.enable_only(moderngl.NOTHING)
    gl.framebuffer([integers, floats]).use()
    gl.vertex_array(program, []).render(moderngl.TRIANGLES, vertices=3)
    fetched = np.frombuffer(integers.read(), np.uint32).reshape(-1, 4)
    assert np.array_equal(fetched[:, 0].view(np.int32), table["signed"])
    assert np.array_equal(fetched[:, 1], table["mask"])
    assert np.array_equal(fetched[:, 2:], np.stack([table["mask"] >> 31, table["signed"] < 0], 1))
    assert np.array_equal(np.frombuffer(floats.read(), "f4").reshape(-1, 4)[0, :3], np.float32([-1.5, 2.5, 1e-38]))


def test_a_table_may_be_empty(device):
    assert LIGHT.upload(device, np.zeros(0, LIGHT.dtype)).bytes > 0


def test_octahedral_encoding_is_invertible():
    random = np.random.default_rng(0).normal(size=(10_000, 3))
    directions = np.concatenate([random / np.linalg.norm(random, axis=1)[:, None], np.eye(3), -np.eye(3)])
    points = octahedron_from_directions(directions)
    assert np.abs(points).max() <= 1.0
    assert directions_from_octahedron(points) == pytest.approx(directions, abs=1e-12)


def test_python_and_glsl_encode_directions_alike(device):
    random = np.random.default_rng(1).normal(size=(1000, 3)).astype("f4")
    directions = random / np.linalg.norm(random, axis=1)[:, None]
    library = (FOLDER / "glsl/maths/octahedron.glsl").read_text()
    encoded = run(
        device,
        f"{library}\nuniform samplerBuffer table;",
        "vec4(octahedron_from_direction(texelFetch(table, row).xyz), 0, 0)",
        1000,
        {"table": device.buffer_from(np.pad(directions, ((0, 0), (0, 1))))},
    )
    assert encoded[:, :2] == pytest.approx(octahedron_from_directions(directions.astype(float)), abs=1e-6)
