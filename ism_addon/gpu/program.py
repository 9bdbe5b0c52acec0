# SPDX-License-Identifier: GPL-3.0-or-later
"""Load, complete and compile shaders; say in which file an error is.

A shader's text is its file with `#include "lib/name.glsl"` resolved (each file once), after a head that
holds the GLSL version, fetch.glsl, the frame's block, the records it reads and the constants that Python also knows.
"""

import re
from pathlib import Path

import moderngl

from . import block
from .context import Device
from .layout import WIDTH, Record

FOLDER = Path(__file__).parent / "shaders"
STAGES = {".vert": "vertex_shader", ".frag": "fragment_shader"}
INCLUDE = re.compile(r'^#include "(.+)"$')


class ShaderError(RuntimeError):
    """A shader does not compile; the message names its files."""


def expand(path: Path, files: list[Path]) -> str:
    """A file's text with its includes; `files` grows by each file read, and numbers it for #line."""
    files.append(path)
    number = len(files) - 1
    lines = [f"#line 1 {number}"]
    for count, line in enumerate(path.read_text().splitlines(), 1):
        include = INCLUDE.match(line)
        if not include:
            lines.append(line)
        elif (FOLDER / include[1]) not in files:
            lines += [expand(FOLDER / include[1], files), f"#line {count + 1} {number}"]
    return "\n".join(lines)


def head(records: tuple[Record, ...], constants: dict[str, int | float]) -> str:
    """What stands before every shader's own text."""
    lines = ["#version 410 core", f"#define WIDTH {WIDTH}"]
    lines += [f"#define {name.upper()} {value}" for name, value in constants.items()]
    lines += [(FOLDER / "lib" / "fetch.glsl").read_text(), block.GLSL, *(record.glsl() for record in records), ""]
    return "\n".join(lines)


def compile_program(
    device: Device, *names: str, records: tuple[Record, ...] = (), **constants: int | float
) -> moderngl.Program:
    """The program of the files `names` in the shader folder, one a stage; compiled once. Raises ShaderError."""
    key = (names, tuple(record.name for record in records), tuple(constants.items()))
    if key not in device.programs:
        device.programs[key] = compile_stages(device.gl, names, records, constants)
    return device.programs[key]


def compile_stages(
    gl: moderngl.Context, names: tuple[str, ...], records: tuple[Record, ...], constants: dict[str, int | float]
) -> moderngl.Program:
    """Compile and link, with the frame's block bound."""
    begin = head(records, constants)
    listing: list[str] = []
    stages = {}
    for name in names:
        files: list[Path] = []
        stages[STAGES[Path(name).suffix]] = begin + expand(FOLDER / name, files)
        listing.append(", ".join(f"{k} is {file.name}" for k, file in enumerate(files)))
    try:
        program = gl.program(**stages)
    except moderngl.Error as error:
        raise ShaderError(f"the shader {' + '.join(names)} does not compile ({'; '.join(listing)}): {error}") from error
    if block.NAME in program:
        program[block.NAME].binding = block.BINDING
    return program


def bind(program: moderngl.Program, **values: object) -> None:
    """Give uniforms their values, and samplers their textures; what the compiler left out is passed over."""
    for unit, (name, value) in enumerate(values.items()):
        if name not in program:
            continue
        if isinstance(value, moderngl.Texture):
            value.use(unit)
            value = unit
        program[name].value = value
