# SPDX-License-Identifier: GPL-3.0-or-later
"""The Khronos reference compiler checks every program that a test compiles, and rejects what is not GLSL 4.10."""

import re

import pytest

from ism_addon.gpu.gl import driver_variants
from tests.tools import glslang

VERTEX = "#version 410 core\nout float height;\nvoid main() { gl_Position = vec4(height = 0.5); }\n"


def fragment(body: str, declared: str = "", version: str = "410 core") -> str:
    return f"#version {version}\n{declared}out vec4 color;\n#line 20001\nvoid main() {{\n{body}\ncolor = vec4(x); }}\n"


def sampling(count: int) -> str:
    """A fragment shader with `count` samplers."""
    declared = "".join(f"uniform samplerBuffer buffer_{k};\n" for k in range(count - 1)) + "uniform usampler2D whole;\n"
    fetches = "".join(f" + texelFetch(buffer_{k}, 0).x" for k in range(count - 1))
    return fragment(f"float x = float(texelFetch(whole, ivec2(0), 0).x){fetches};", declared)


#: Shaders that Mesa accepts, and the error that the reference compiler reports.
FAULTS = {
    "a reserved word": (fragment("float shared = 1.0;\nfloat x = shared;"), r"(?s)SHARED.*in the line: float shared"),
    "a semicolon too many": (fragment("float x = 1.0;", "struct S { float f; };;\n"), "extraneous semicolon"),
    "another version": (fragment("float x = 1.0;", version="430 core"), "does not begin with #version 410 core"),
    "17 samplers": (sampling(17), r"17 samplers in the fragment_shader, of 16 at most: whole, buffer_0"),
}


@pytest.mark.parametrize(("shader", "sentence"), FAULTS.values(), ids=FAULTS)
def test_what_the_driver_accepts_against_the_standard_fails_the_test(device, reference_compiler, shader, sentence):
    device.gl.program(vertex_shader=VERTEX, fragment_shader=shader)
    with pytest.raises(AssertionError, match=sentence):
        reference_compiler.check()


@pytest.mark.parametrize(
    ("body", "declared", "sentence"),
    [
        ("int x = 1.5;", "", "(?s)cannot convert from .*in the line: int x = 1.5;"),
        ("float x = nowhere;", "", "(?s)undeclared identifier.*in the line: float x = nowhere;"),
        ("float x = height.x;", "in vec2 height;\n", "(?s)Linking vertex and fragment stages: Types must match"),
    ],
)
def test_errors_that_drivers_report_are_reported(body, declared, sentence):
    fault = glslang.find_fault({"vertex_shader": VERTEX, "fragment_shader": fragment(body, declared)})
    assert re.search(sentence, fault), fault


def test_sixteen_samplers_are_accepted(device, reference_compiler):
    device.gl.program(vertex_shader=VERTEX, fragment_shader=sampling(driver_variants.SAMPLERS))
    assert len(reference_compiler.waiting) == 1
    reference_compiler.check()


def test_each_program_is_compiled_once(device, reference_compiler):
    for _ in range(2):
        device.gl.program(vertex_shader=VERTEX, fragment_shader=fragment("float x = 0.125;"))
    assert len(reference_compiler.waiting) == 1
