# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the extension's zips, one a platform: our tracked files, the wheels, and Blender's own tool."""

import itertools
import json
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from . import pip, project

BUILD = project.ROOT / "build"


def build(python: Path, tool: Sequence[str], output: Path, platforms: Sequence[str] = ()) -> list[Path]:
    """Zips in `output`, each found valid, for some platforms or all. `python` has pip; `tool` is Blender's."""
    source = output / "source"
    _stage(source, {name: _wheels(python, name) for name in platforms or project.WHEELS})
    for old in output.glob("*.zip"):
        old.unlink()
    _blender(*tool, "build", "--source-dir", str(source), "--output-dir", str(output), "--split-platforms")
    zips = sorted(output.glob("*.zip"))
    for path in zips:
        _blender(*tool, "validate", str(path))
    return zips


def _wheels(python: Path, platform: str) -> list[Path]:
    """Download what the platform's zip carries, once."""
    carried = project.WHEELS[platform]
    folder = BUILD / "wheels" / platform
    for version in carried["python"]:
        for package in carried["packages"]:
            name = package.replace("==", "-")
            if not list(folder.glob(f"{name}-cp{version.replace('.', '')}-*.whl")):
                target = ["--python-version", version, *(f"--platform={tag}" for tag in carried["tags"])]
                choice = ["--implementation=cp", "--only-binary=:all:", "--no-deps"]
                pip.run(python, "download", *target, *choice, "--dest", str(folder), package)
    names = [package.replace("==", "-") for package in carried["packages"]]
    return sorted(wheel for name in names for wheel in folder.glob(f"{name}-*.whl"))


def _stage(source: Path, wheels: dict[str, list[Path]]) -> None:
    """The files that git does not ignore, with a manifest that names the platforms and the wheels."""
    shutil.rmtree(source, ignore_errors=True)
    for name in project.files():
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(project.ROOT / name, source / name)
    (source / "wheels").mkdir()
    names = []
    for wheel in itertools.chain(*wheels.values()):
        shutil.copy2(wheel, source / "wheels")
        names.append(f"./wheels/{wheel.name}")
    manifest = source / "blender_manifest.toml"
    head = f"platforms = {json.dumps(list(wheels))}\nwheels = {json.dumps(names, indent=2)}\n\n"
    manifest.write_text(head + manifest.read_text("utf-8"), "utf-8")


def _blender(*command: str) -> None:
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        sys.exit(f"Blender's tool for extensions failed:\n{done.stdout}")
