# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks programs that tests compile by the Khronos reference compiler: drivers accept more than GLSL 4.10 allows."""

import hashlib
import inspect
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any
from unittest import mock

import moderngl

from tests.tools import project

PROGRAM = "glslangValidator"
#: Has an empty file for each program that was accepted, named by its digest: other processes need not check it again.
ACCEPTED = project.ROOT / "build" / "reference_compiler"
ADVICE = "it is in Debian's glslang-tools, in Homebrew's glslang and in the Vulkan SDK"
#: moderngl's name of a stage to the suffix by which the compiler knows it, and its bit in the compiler's report.
STAGES = {"vertex_shader": (".vert", 1), "fragment_shader": (".frag", 16)}
#: GL_MAX_TEXTURE_IMAGE_UNITS and GL_MAX_VERTEX_TEXTURE_IMAGE_UNITS that OpenGL 4.1 guarantees.
MAX_SAMPLERS = 16
#: OpenGL's enumerants of sampler types.
SAMPLER_TYPES = {
    *range(0x8B5D, 0x8B65),  # GL_SAMPLER_1D … GL_SAMPLER_2D_RECT_SHADOW
    *range(0x8DC0, 0x8DC6),  # GL_SAMPLER_1D_ARRAY … GL_SAMPLER_CUBE_SHADOW
    *range(0x8DC9, 0x8DD9),  # GL_INT_SAMPLER_1D … GL_UNSIGNED_INT_SAMPLER_BUFFER
    *range(0x900C, 0x9010),  # GL_SAMPLER_CUBE_MAP_ARRAY …
    *range(0x9108, 0x910E),  # GL_SAMPLER_2D_MULTISAMPLE …
}
UNIFORM = re.compile(r"^(\w+)(?:\[0\])?: offset -?\d+, type ([0-9a-f]+), size (\d+), .*\bstages (\d+)", re.M)
ERROR = re.compile(r"^ERROR: \S*(\.vert|\.frag):(\d+): ", re.M)
LINE = re.compile(r"#line (\d+)$")

Texts = tuple[tuple[str, str], ...]


@dataclass
class ReferenceCompiler:
    """Collects the texts of programs that drivers accepted, without duplicates: by stage, as moderngl names them."""

    known: set[Texts] = field(default_factory=set)
    waiting: list[Texts] = field(default_factory=list)

    @contextmanager
    def watching(self) -> Iterator[None]:
        """Note each program that moderngl compiles inside this with-block."""
        compile_program = moderngl.Context.program
        signature = inspect.signature(compile_program)

        def compile_and_note(*arguments: Any, **named: Any) -> moderngl.Program:
            program = compile_program(*arguments, **named)
            given = signature.bind(*arguments, **named).arguments
            self.note(tuple((stage, given[stage]) for stage in STAGES if stage in given))
            return program

        with mock.patch.object(moderngl.Context, "program", compile_and_note):
            yield

    def note(self, texts: Texts) -> None:
        """Keep these texts for `check`, if they are new."""
        if texts not in self.known:
            self.known.add(texts)
            self.waiting.append(texts)

    def check(self) -> None:
        """Compile and link the waiting programs. Raises AssertionError with the error and its line."""
        assert not self.waiting or shutil.which(PROGRAM), f"there is no {PROGRAM}: {ADVICE}"
        ACCEPTED.mkdir(parents=True, exist_ok=True)
        while self.waiting:
            texts = self.waiting.pop()
            if not (accepted := ACCEPTED / digest(texts)).exists():
                fault = find_fault(dict(texts))
                assert not fault, fault
                accepted.touch()


@cache
def compiler_digest() -> str:
    """Of this file, and of the size and date of the compiler's."""
    program = Path(shutil.which(PROGRAM) or "").stat()
    return f"{hashlib.sha256(Path(__file__).read_bytes()).hexdigest()} {program.st_size} {program.st_mtime_ns}"


def digest(texts: Texts) -> str:
    """Of a program, and of what accepts it."""
    return hashlib.sha256(repr((compiler_digest(), texts)).encode()).hexdigest()


def find_fault(texts: dict[str, str]) -> str:
    """Why a program violates GLSL 4.10 or needs more than OpenGL 4.1 guarantees; empty if it does neither."""
    if not all(text.lstrip().startswith("#version 410 core\n") for text in texts.values()):
        return "a shader does not begin with #version 410 core"
    with tempfile.TemporaryDirectory() as folder:
        paths = []
        for stage, text in texts.items():
            paths.append(Path(folder, "shader").with_suffix(STAGES[stage][0]))
            paths[-1].write_text(text.lstrip(), "utf-8")
        result = subprocess.run([PROGRAM, "-l", "-q", *paths], capture_output=True, text=True)
    if result.returncode:
        return f"the reference compiler refuses what the driver accepted:\n{_with_source_line(result.stdout, texts)}"
    for stage in texts:
        samplers = used_samplers(result.stdout, stage)
        if sum(samplers.values()) > MAX_SAMPLERS:
            return f"{sum(samplers.values())} samplers in the {stage}, of {MAX_SAMPLERS} at most: {', '.join(samplers)}"
    return ""


def used_samplers(report: str, stage: str) -> dict[str, int]:
    """Names of the samplers that a stage uses to their array sizes, from the compiler's report (`-l -q`)."""
    uniforms = report.partition("Uniform reflection:")[2].partition("Uniform block reflection:")[0]
    samplers = {}
    for name, type_, count, stages in UNIFORM.findall(uniforms):
        if int(type_, 16) in SAMPLER_TYPES and int(stages) & STAGES[stage][1]:
            samplers[name] = int(count)
    return samplers


def _with_source_line(report: str, texts: dict[str, str]) -> str:
    """The compiler's messages, and the source line of the first error."""
    messages = report.partition("Uniform reflection:")[0].strip()
    if error := ERROR.search(messages):
        stage = next(stage for stage, (suffix, _) in STAGES.items() if suffix == error[1])
        line_number = 0
        for line in texts[stage].lstrip().splitlines():
            line_number += 1
            if line_number == int(error[2]):
                return f"{messages}\nin the line: {line.strip()}"
            if start := LINE.match(line):
                line_number = int(start[1]) - 1
    return messages
