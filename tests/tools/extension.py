# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the extension's zips, one a platform: our tracked files, the wheels, and Blender's own tool."""

import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from . import pip, project

BUILD = project.ROOT / "build"


def build(python: Path, tool: Sequence[str], output: Path, platforms: Sequence[str] = tuple(project.WHEELS)) -> list[Path]:
    """The zips in `output`, each found valid. `tool` begins a command of Blender's for extensions, `python` has pip."""
    source = output / "source"
    _stage(source, {name: _wheels(python, name) for name in platforms})
    for old in output.glob("*.zip"):
        old.unlink()
    arguments = ["--source-dir", str(source), "--output-dir", str(output), "--split-platforms"]
    _blender([*tool, "build", *arguments])
    zips = sorted(output.glob("*.zip"))
    for path in zips:
        _blender([*tool, "validate", str(path)])
    return zips


def _wheels(python: Path, platform: str) -> list[Path]:
    """Download what the platform's zip carries, once."""
    carried = project.WHEELS[platform]
    wheels = []
    for version in carried["python"]:
        folder = BUILD / "wheels" / platform / version
        if len(list(folder.glob("*.whl"))) != len(carried["packages"]):
            chosen = [word for tag in carried["tags"] for word in ("--platform", tag)]
            chosen += ["--implementation", "cp", "--python-version", version, "--only-binary=:all:", "--no-deps"]
            pip.run(python, "download", *chosen, "--dest", str(folder), *carried["packages"])
        wheels += sorted(folder.glob("*.whl"))
    return wheels


def _stage(source: Path, wheels: dict[str, list[Path]]) -> None:
    """The files that git does not ignore, with a manifest that names the platforms and the wheels."""
    shutil.rmtree(source, ignore_errors=True)
    for name in project.files():
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(project.ROOT / name, source / name)
    (source / "wheels").mkdir()
    for wheel in sum(wheels.values(), []):
        shutil.copy2(wheel, source / "wheels")
    names = sorted(f"./wheels/{wheel.name}" for wheel in sum(wheels.values(), []))
    manifest = source / "blender_manifest.toml"
    manifest.write_text(f"platforms = {list(wheels)}\nwheels = {names}\n\n" + manifest.read_text("utf-8"), "utf-8")


def _blender(command: list[str]) -> None:
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        sys.exit(f"Blender's tool for extensions failed:\n{done.stdout}")
