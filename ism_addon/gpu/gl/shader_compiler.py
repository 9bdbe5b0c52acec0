# SPDX-License-Identifier: GPL-3.0-or-later
"""Load, complete and compile shaders; say in which file an error is.

A shader's text is its file with `#include "folder/name.glsl"`, of the folder `glsl`, resolved (each file once), after a
head that holds the GLSL version, fetch.glsl, the frame's block, the records it reads and the constants that Python also
knows.
"""

import re
from pathlib import Path
from typing import Any, cast

import moderngl

from . import frame_uniforms
from .buffer_texture import BufferTexture
from .context import Device
from .shader_records import Record

#: Shaders are named by their path in it: each lies beside its pass, and what several include or draw with in `glsl`.
FOLDER = Path(__file__).parents[1]
STAGES = {".vert": "vertex_shader", ".frag": "fragment_shader"}
INCLUDE = re.compile(r'^#include "(.+)"$')
#: Lines of the k-th file of a shader are counted from k times this: Mesa forgets the file that #line names.
LINES_PER_FILE = 10_000
#: A uniform's declaration: its name.
UNIFORM = re.compile(r"^uniform \w+ (\w+)", re.M)
#: The first error that a compiler tells of: its line, and what is wrong.
#: Mesa and Intel write 0:33(2): error: …, NVIDIA 0(33) : error C1503: …, AMD and Apple ERROR: 0:33: …
FIRST_ERROR = re.compile(r"^(?:ERROR: )?\d+[:(](\d+)(?:\(\d+\)|\))? ?: *(.*)$", re.M)


class ShaderError(RuntimeError):
    """A shader does not compile; the message is one line that names the file and the place in it."""


def expand(path: Path, files: list[Path]) -> str:
    """A file's text with its includes; `files` grows by each file read, and says where its lines are counted from."""
    files.append(path)
    start = len(files) * LINES_PER_FILE
    lines = [f"#line {start + 1}"]
    for count, line in enumerate(path.read_text("utf-8").splitlines(), 1):
        include = INCLUDE.match(line)
        if not include:
            lines.append(line)
        elif (included := FOLDER / "glsl" / include[1]) not in files:
            lines += [expand(included, files), f"#line {start + count + 1}"]
    return "\n".join(lines)


def head(records: tuple[Record, ...], constants: dict[str, int | float]) -> str:
    """What stands before every shader's own text."""
    lines = ["#version 410 core"]
    lines += [f"#define {name.upper()} {value}" for name, value in constants.items()]
    fetch = (FOLDER / "glsl/textures/fetch.glsl").read_text("utf-8")
    lines += [fetch, frame_uniforms.GLSL, *(record.glsl() for record in records), ""]
    return "\n".join(lines)


def compile_program(
    device: Device, *names: str, records: tuple[Record, ...] = (), **constants: int | float
) -> moderngl.Program:
    """The program of the files `names` in the shader folder, one a stage; compiled once. Raises ShaderError."""
    key = (names, tuple(record.name for record in records), tuple(constants.items()))
    if key not in device.programs:
        for begins in device.on_compile:
            begins()
        device.programs[key] = compile_stages(device.gl, names, records, constants)
    return device.programs[key]


def compile_stages(
    gl: moderngl.Context, names: tuple[str, ...], records: tuple[Record, ...], constants: dict[str, int | float]
) -> moderngl.Program:
    """Compile and link, with the frame's block bound."""
    begin = head(records, constants)
    files: dict[str, list[Path]] = {STAGES[Path(name).suffix]: [] for name in names}
    try:
        texts = (begin + expand(FOLDER / name, files[stage]) for name, stage in zip(names, files, strict=True))
        stages: dict[str, Any] = dict(zip(files, texts, strict=True))
        program = gl.program(**stages)
    except (moderngl.Error, OSError) as error:
        raise ShaderError(f"the shader {' + '.join(names)} does not compile: {first_error(error, files)}") from error
    program.extra = frozenset(name for source in stages.values() for name in UNIFORM.findall(source))
    if frame_uniforms.NAME in program:
        cast(moderngl.UniformBlock, program[frame_uniforms.NAME]).binding = frame_uniforms.BINDING
    return program


def first_error(error: Exception, files: dict[str, list[Path]]) -> str:
    """Where and what it is, or all that was said if that cannot be told; `files` are those of each stage."""
    said = str(error)
    found = FIRST_ERROR.search(said)
    stage = next((stage for stage in files if stage in said), None)
    number, line = divmod(int(found[1]), LINES_PER_FILE) if found else (0, 0)
    if found is None or not number or stage is None:  # in what stands before the files, or as the program is linked
        return " ".join(said.split())
    return f"{files[stage][number - 1].name}, line {line}: {found[2]}"


class UndeclaredUniformError(RuntimeError):
    """A pass sets a uniform that no source of its program declares. A fault of the pass, which no scene can cause."""


def bind(program: moderngl.Program, **values: object) -> None:
    """Give uniforms their values, and samplers their textures; what the compiler left out is passed over.

    Raises UndeclaredUniformError for a name that the program's sources do not have.
    """
    held = program.ctx.extra
    for name, value in values.items():
        uniform: Any = program.get(name, None)
        if uniform is None:
            if name not in program.extra:
                raise UndeclaredUniformError(f"no source of the program declares the uniform {name}")
            continue
        if isinstance(value, BufferTexture):
            unit = held.unit_with(name, value)
            if held.is_new(program, name, unit):
                value.tell(program, name, unit)
        else:
            content = held.unit_with(name, value) if isinstance(value, moderngl.Texture) else value
            if held.is_new(program, name, content):
                uniform.value = content
