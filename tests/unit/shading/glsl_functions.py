# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluates a GLSL function for many operands, one pixel each."""

from collections.abc import Sequence
from types import MappingProxyType

import moderngl
import numpy as np

from ism_addon.gpu.gl.context import Device
from ism_addon.gpu.gl.shader_compiler import Constants, Include, bind, compile_program

#: Columns of the picture, so that it is within OpenGL's limits.
COLUMNS = 512

FILE = "function.frag"


def evaluate(
    device: Device,
    include: str,
    call: str,
    operands: Sequence[np.ndarray],
    constants: Constants = MappingProxyType({}),
    **uniforms: object,
) -> np.ndarray:
    """(N,4) float32: the results of a call, in which a0, a1, … stand for the operands, (N,) or (N,2 to 4) each.

    Results of fewer components are padded by zeros. `include`: the file of the function, with these constants.
    """
    count = len(operands[0])
    rows = np.zeros((count, len(operands), 4), np.float32)
    lines = []
    for k, operand in enumerate(operands):
        values = operand.reshape(count, -1)
        rows[:, k, : values.shape[1]] = values
        type_ = {1: "float", 2: "vec2", 3: "vec3", 4: "vec4"}[values.shape[1]]
        fetch = f"texelFetch(operands, {len(operands)} * row + {k})"
        lines.append(f"    {type_} a{k} = {fetch}.{'xyzw'[: values.shape[1]]};")
    text = f"""
#include "{include}"
uniform samplerBuffer operands;
out vec4 result;
vec4 padded(float a) {{ return vec4(a, 0.0, 0.0, 0.0); }}
vec4 padded(vec2 a) {{ return vec4(a, 0.0, 0.0); }}
vec4 padded(vec3 a) {{ return vec4(a, 0.0); }}
vec4 padded(vec4 a) {{ return a; }}
void main() {{
    int row = int(gl_FragCoord.y) * {COLUMNS} + int(gl_FragCoord.x);
{chr(10).join(lines)}
    result = padded({call});
}}
"""
    program = compile_program(device, "glsl/full_screen.vert", f"glsl/{FILE}", Include(FILE, text), **constants)
    height = -(-count // COLUMNS)
    texture = device.gl.texture((COLUMNS, height), 4, dtype="f4")
    framebuffer = device.gl.framebuffer([texture])
    framebuffer.use()
    device.enable_only(moderngl.NOTHING)
    bind(program, operands=device.buffer_from(rows.reshape(-1, 4)), **uniforms)
    device.gl.vertex_array(program, []).render(moderngl.TRIANGLES, vertices=3)
    return np.frombuffer(texture.read(), np.float32).reshape(-1, 4)[:count]
