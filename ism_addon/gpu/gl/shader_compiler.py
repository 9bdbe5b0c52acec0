# SPDX-License-Identifier: GPL-3.0-or-later
"""Loads shaders, resolves includes and compiles; error messages name the file.

The source of a stage is a head and its file. `#include "folder/name.glsl"` is resolved in the folder `glsl`, each file
once. The head has the GLSL version, constants from Python, fetch.glsl, the frame's uniform block and the records.
"""

import os
import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias, cast

import moderngl

from . import frame_uniforms
from .bound_state import is_new
from .buffer_texture import BufferTexture, RecordTable
from .context import Device
from .shader_records import Record

#: Shaders are named by their path in this folder. They are beside their pass, or in `glsl` if several passes use them.
FOLDER = Path(__file__).parents[1]
STAGES = {".vert": "vertex_shader", ".frag": "fragment_shader"}
INCLUDE = re.compile(r'^#include "(.+)"$')
#: Line numbers of the k-th file of a shader start at k times this: Mesa drops the file number of #line.
LINES_PER_FILE = 10_000
#: A uniform's declaration; group 1 is its name.
UNIFORM = re.compile(r"^uniform \w+ (\w+)", re.M)
#: The first error of a compiler's log: line and message.
#: Mesa and Intel write 0:33(2): error: …, NVIDIA 0(33) : error C1503: …, AMD and Apple ERROR: 0:33: …
FIRST_ERROR = re.compile(r"^(?:ERROR: )?\d+[:(](\d+)(?:\(\d+\)|\))? ?: *(.*)$", re.M)


#: Constants from Python by their names, in lower case.
Constants = Mapping[str, int | float]

#: Generated includes by name: functions that return their source, in a shader with these constants.
GENERATED: dict[str, Callable[[Constants], str]] = {}


class Include(NamedTuple):
    """A file in `glsl` that one program alone includes."""

    name: str
    text: str


class ShaderError(RuntimeError):
    """A shader does not compile. The message is one line with file and line number."""


def text_of(path: Path, constants: Constants, includes: tuple[Include, ...]) -> str:
    """The text of a file: generated for the program, for its constants, or read."""
    name = path.relative_to(FOLDER / "glsl").as_posix() if path.is_relative_to(FOLDER / "glsl") else ""
    own = next((include.text for include in includes if include.name == name), None)
    if own is not None:
        return own
    return GENERATED[name](constants) if name in GENERATED else path.read_text("utf-8")


def expand(path: Path, files: list[Path], constants: Constants, includes: tuple[Include, ...] = ()) -> str:
    """A file's source with its includes. Appends each file read to `files`; its index gives its line numbers.

    `constants` and `includes`: of the shader.
    """
    return _expand(path, files, constants, includes, {path})


def _expand(
    path: Path, files: list[Path], constants: Constants, includes: tuple[Include, ...], present: set[Path]
) -> str:
    """`present`: files whose text comes before for all constants. Others may be repeated: #if may leave them out."""
    files.append(path)
    start, depth = len(files) * LINES_PER_FILE, 0
    guard = re.sub(r"[\W_]+", "_", f"FILE {os.path.relpath(path, FOLDER)}").upper()
    lines = [f"#ifndef {guard}", f"#define {guard}", f"#line {start + 1}"]
    for count, line in enumerate(text_of(path, constants, includes).splitlines(), 1):
        include = INCLUDE.match(line)
        if not include:
            depth += line.startswith("#if") - line.startswith("#endif")
            lines.append(line)
            if line.startswith("#endif"):  # an include may have been skipped, with its line numbers
                lines.append(f"#line {start + count + 1}")
        elif (included := Path(os.path.normpath(FOLDER / "glsl" / include[1]))) not in present:
            known = present if depth == 0 else set(present)
            known.add(included)
            lines += [_expand(included, files, constants, includes, known), f"#line {start + count + 1}"]
    return "\n".join([*lines, "#endif"])


def head(records: tuple[Record, ...], constants: Constants) -> str:
    """The head of a stage's source."""
    lines = ["#version 410 core"]
    lines += [f"#define {name.upper()} {value}" for name, value in constants.items()]
    fetch = (FOLDER / "glsl/textures/fetch.glsl").read_text("utf-8")
    lines += [fetch, frame_uniforms.GLSL, *(record.glsl() for record in records), ""]
    return "\n".join(lines)


class ProgramSource(NamedTuple):
    """What a program is compiled from: files, one for each stage, includes, records and constants."""

    sources: tuple[str | Include, ...]
    records: tuple[Record, ...]
    constants: tuple[tuple[str, int | float], ...]


#: What the sources of a program include besides files.
Part: TypeAlias = Record | Include


def split_parts(parts: Iterable[Part]) -> tuple[tuple[Include, ...], tuple[Record, ...]]:
    """The includes and the records among parts of a shader, each once."""
    parts = tuple(dict.fromkeys(parts))
    includes = tuple(each for each in parts if isinstance(each, Include))
    return includes, tuple(each for each in parts if isinstance(each, Record))


def compile_program(
    device: Device, *sources: str | Include, records: tuple[Record, ...] = (), **constants: int | float
) -> moderngl.Program:
    """The program of these files, one for each stage, and of includes. Programs are cached. Raises ShaderError."""
    return program_of(device, ProgramSource(sources, records, tuple(constants.items())))


def program_of(device: Device, source: ProgramSource) -> moderngl.Program:
    """As compile_program."""
    if source not in device.programs:
        for callback in device.on_compile:
            callback()
        names = tuple(each for each in source.sources if isinstance(each, str))
        includes = tuple(each for each in source.sources if isinstance(each, Include))
        constants = dict(source.constants)
        try:
            device.programs[source] = compile_stages(device.gl, names, source.records, includes, constants)
        except ShaderError as error:
            device.programs[source] = error
    program = device.programs[source]
    if isinstance(program, Exception):
        raise program
    return program


def compile_stages(
    gl: moderngl.Context,
    names: tuple[str, ...],
    records: tuple[Record, ...],
    includes: tuple[Include, ...],
    constants: Constants,
) -> moderngl.Program:
    """Compile, link and bind the frame's uniform block."""
    head_source = head(records, constants)
    files: dict[str, list[Path]] = {STAGES[Path(name).suffix]: [] for name in names}
    try:
        stages: dict[str, Any] = {
            stage: head_source + expand(FOLDER / name, files[stage], constants, includes)
            for name, stage in zip(names, files, strict=True)
        }
        program = gl.program(**stages)
    except (moderngl.Error, OSError) as error:
        raise ShaderError(f"the shader {' + '.join(names)} does not compile: {first_error(error, files)}") from error
    program.extra = frozenset(name for source in stages.values() for name in UNIFORM.findall(source))
    if frame_uniforms.NAME in program:
        cast(moderngl.UniformBlock, program[frame_uniforms.NAME]).binding = frame_uniforms.BINDING
    return program


def first_error(error: Exception, files: dict[str, list[Path]]) -> str:
    """File, line and message of the first error, or the complete log if it is not recognised. `files` by stage."""
    log = str(error)
    match = FIRST_ERROR.search(log)
    stage = next((stage for stage in files if stage in log), None)
    file, line = divmod(int(match[1]), LINES_PER_FILE) if match else (0, 0)
    if match is None or not file or stage is None:  # an error in the head, or of linking
        return " ".join(log.split())
    return f"{files[stage][file - 1].name}, line {line}: {match[2]}"


class UndeclaredUniformError(RuntimeError):
    """A pass sets a uniform that its program's sources do not declare: a programming error."""


def bind(program: moderngl.Program, **values: object) -> None:
    """Set uniforms and samplers. Those that the compiler has optimised away are skipped.

    The uniform of a RecordTable is its first row; the sampler of its buffer is textures/scene_records.glsl's.

    Raises UndeclaredUniformError for a name that the program's sources do not declare.
    """
    state = program.ctx.extra
    current_values = state.values(program)
    records: BufferTexture | None = None
    for name, value in values.items():
        uniform: Any = program.get(name, None)
        if uniform is None:
            if name not in program.extra:
                raise UndeclaredUniformError(f"no source of the program declares the uniform {name}")
            continue
        if isinstance(value, RecordTable):
            records, value = value.buffer, value.first_row
        if isinstance(value, BufferTexture):
            unit = state.unit_with(name, value)
            if is_new(current_values, name, unit):
                value.set_sampler(program, name, unit)
        else:
            content = (
                state.unit_with(name, value) if isinstance(value, moderngl.Texture | moderngl.TextureArray) else value
            )
            if is_new(current_values, name, content):
                uniform.value = content
    if records is not None:
        bind(program, scene_records=records)
