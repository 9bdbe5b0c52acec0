# SPDX-License-Identifier: GPL-3.0-or-later
"""Environments with Blender in which our code can run: virtual environments with bpy, or the `blender` on the PATH."""

import hashlib
import itertools
import os
import re
import shutil
import subprocess
import sys
import venv
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from . import pip, project

FOLDER = project.ROOT / ".venv"
PYTHON = f"{sys.version_info.major}.{sys.version_info.minor}"
ADVICE = f"Use Python {' or '.join(project.BPY)}, which have one, or a Blender from 4.2 on."
INSIDE_BLENDER = Path(__file__).with_name("inside_blender.py")


@dataclass(frozen=True)
class Environment:
    """A Python that has Blender's modules, and Blender's tool for extensions."""

    name: str
    python: Path  # an interpreter whose pip is the pinned one
    module: tuple[str, ...]  # command that runs a Python module; its name follows
    extension: tuple[str, ...]  # command of Blender's tool; a verb follows
    target: tuple[str, ...] = ()  # pip's arguments, where packages are not installed for the interpreter itself
    has_processes: bool = True  # whether its processes can start others with Blender's modules, as xdist does

    def add(self, *requirements: str) -> None:
        """Install further packages, once."""
        stamp = self.python.parents[1] / "further.txt"
        if not stamp.exists() or stamp.read_text() != "\n".join(requirements):
            pip.install(self.python, *self.target, *requirements)
            stamp.write_text("\n".join(requirements))

    def run(self, module: str, *arguments: str, **variables: str) -> int:
        """`python -m module arguments` in the project's root, with environment variables: its exit status.

        Bytecode is written: a test run starts a hundred processes, each of which would compile all modules again.
        """
        environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "", **variables}
        return subprocess.run([*self.module, module, *arguments], cwd=project.ROOT, env=environment).returncode


def environments() -> Iterator[Environment]:
    """All environments of this Python, the default first; each is set up when it is reached. Exits if there is none."""
    if PYTHON in project.BPY:
        yield from map(_with_bpy, project.BPY[PYTHON])
    else:
        yield _with_blender()


def all_environments(pool: ThreadPoolExecutor) -> Iterator[Environment]:
    """`environments`. The first is set up alone, as tests wait for it; then all others, by a pool."""
    default = next(environments())
    others = pool.map(_with_bpy, project.BPY.get(PYTHON, ())[1:])
    yield default
    yield from others


def _with_bpy(version: str) -> Environment:
    folder = FOLDER / f"bpy-{version}"
    groups = (project.PACKAGES[group] for group in ("gpu", "bpy", "test"))
    python = _set_up(folder, f"bpy=={version}", *itertools.chain(*groups))
    tools = folder.glob("[Ll]ib/**/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py")
    return Environment(f"bpy {version}", python, (str(python), "-m"), (str(python), str(next(tools))))


def _with_blender() -> Environment:
    program = shutil.which("blender")
    if program is None:
        sys.exit(f"Python {PYTHON} has no bpy, and there is no blender on the PATH. {ADVICE}")
    version, python_version = _blender_versions(program)
    if version < (4, 2):
        sys.exit(f"Python {PYTHON} has no bpy, and the blender on the PATH is too old. {ADVICE}")
    name = "blender-" + ".".join(map(str, version))
    packages = FOLDER / name / "for-blender"
    target = ("--target", str(packages), "--only-binary=:all:", "--python-version", python_version)
    python = _set_up(FOLDER / name, *target, *project.PACKAGES["gpu"], *project.PACKAGES["test"])
    start = (program, "--background", "--factory-startup", "--python-exit-code", "1", "--python", str(INSIDE_BLENDER))
    tool = (program, "--command", "extension")
    return Environment(name, python, (*start, "--", str(packages)), tool, target, has_processes=False)


def _blender_versions(program: str) -> tuple[tuple[int, ...], str]:
    """The versions of Blender and of its Python."""
    expression = "import bpy, sys; print('versions', *bpy.app.version, *sys.version_info[:2])"
    command = [program, "--background", "--factory-startup", "--python-expr", expression]
    result = subprocess.run(command, capture_output=True, text=True)
    answer = re.search(r"^versions (\d+) (\d+) (\d+) (\d+) (\d+)$", result.stdout, re.MULTILINE)
    if answer is None:
        sys.exit(f"{program} does not start. {ADVICE}\n{result.stdout}{result.stderr}")
    *version, major, minor = map(int, answer.groups())
    return tuple(version), f"{major}.{minor}"


def _set_up(folder: Path, *requirements: str) -> Path:
    """Set up a virtual environment with these packages, unless it is there already: its interpreter."""
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    stamp = folder / "requirements.sha256"
    checksum = hashlib.sha256("\n".join([str(folder), sys.version, *requirements]).encode()).hexdigest()
    if not stamp.exists() or stamp.read_text() != checksum:
        print(f"setting up {folder.relative_to(project.ROOT)}", flush=True)
        venv.create(folder, clear=True)
        pip.install_pinned(python)
        pip.install(python, *requirements)
        stamp.write_text(checksum)
    return python
