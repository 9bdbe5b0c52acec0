# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the extension's zips, one a platform: our tracked files, the wheels, and Blender's own tool."""

import itertools
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from . import pip, project

WHEELS = project.ROOT / "build" / "wheels"


def build(python: Path, tool: Sequence[str], output: Path, platforms: Sequence[str] = ()) -> list[Path]:
    """Zips in `output`, each found valid, for some platforms or all. `python` has pip; `tool` is Blender's."""
    wheels = {platform: _wheels(python, platform) for platform in platforms or project.WHEELS}
    output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        source, zips = Path(folder, "source"), Path(folder, "zips")
        _stage(source, wheels)
        zips.mkdir()
        _blender(*tool, "build", "--source-dir", str(source), "--output-dir", str(zips), "--split-platforms")
        for path in zips.iterdir():
            _blender(*tool, "validate", str(path))
        return sorted(Path(shutil.copy2(path, output)) for path in zips.iterdir())


def _wheels(python: Path, platform: str) -> list[Path]:
    """What the platform's zip carries, downloaded once."""
    carried = project.WHEELS[platform]
    folder = WHEELS / platform
    wheels: list[Path] = []
    for version, package in itertools.product(carried["python"], carried["packages"]):
        name = f"{package.replace('==', '-')}-cp{version.replace('.', '')}-*.whl"
        if not any(folder.glob(name)):
            target = [
                "--implementation=cp",
                "--python-version",
                version,
                *(f"--platform={tag}" for tag in carried["tags"]),
            ]
            options = *target, "--only-binary=:all:", "--no-deps"
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=folder) as part:  # another process may look for the same wheel now
                pip.run(python, "download", *options, "--dest", part, package)
                for wheel in Path(part).iterdir():
                    wheel.replace(folder / wheel.name)
        wheels += folder.glob(name)
    return wheels


def _stage(source: Path, wheels: dict[str, list[Path]]) -> None:
    """The files that git does not ignore, with a manifest that names the platforms and the wheels."""
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
