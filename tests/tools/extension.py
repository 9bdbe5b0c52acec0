# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the extension's zips by Blender's tool, one for each platform, from the project's files and wheels."""

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
    """Build and validate zips in `output`, for some platforms or all. `python` has pip; `tool` is Blender's."""
    wheels = {platform: wheels_of(python, platform) for platform in platforms or project.WHEELS}
    output.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        source, zips = Path(folder, "source"), Path(folder, "zips")
        _copy_files(source, wheels)
        zips.mkdir()
        _run_tool(*tool, "build", "--source-dir", str(source), "--output-dir", str(zips), "--split-platforms")
        for path in zips.iterdir():
            _run_tool(*tool, "validate", str(path))
        return sorted(Path(shutil.copy2(path, output)) for path in zips.iterdir())


def wheels_of(python: Path, platform: str) -> list[Path]:
    """The wheels of the platform's zip, downloaded once."""
    contents = project.WHEELS[platform]
    folder = WHEELS / platform
    wheels: list[Path] = []
    for version, package in itertools.product(contents["python"], contents["packages"]):
        name = f"{package.replace('==', '-')}-cp{version.replace('.', '')}-*.whl"
        if not any(folder.glob(name)):
            target = [
                "--implementation=cp",
                "--python-version",
                version,
                *(f"--platform={tag}" for tag in contents["tags"]),
            ]
            options = *target, "--only-binary=:all:", "--no-deps"
            folder.mkdir(parents=True, exist_ok=True)
            # Another process may look for the same wheel now: it must not see an unfinished one.
            with tempfile.TemporaryDirectory(dir=folder) as downloads:
                pip.run(python, "download", *options, "--dest", downloads, package)
                for wheel in Path(downloads).iterdir():
                    wheel.replace(folder / wheel.name)
        wheels += folder.glob(name)
    return wheels


def _copy_files(source: Path, wheels: dict[str, list[Path]]) -> None:
    """Copy the files that git does not ignore and the wheels; add the platforms and the wheels to the manifest."""
    for name in project.files():
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(project.ROOT / name, source / name)
    (source / "wheels").mkdir()
    names = []
    for wheel in itertools.chain(*wheels.values()):
        shutil.copy2(wheel, source / "wheels")
        names.append(f"./wheels/{wheel.name}")
    manifest = source / "blender_manifest.toml"
    header = f"platforms = {json.dumps(list(wheels))}\nwheels = {json.dumps(names, indent=2)}\n\n"
    manifest.write_text(header + manifest.read_text("utf-8"), "utf-8")


def _run_tool(*command: str) -> None:
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        sys.exit(f"Blender's tool for extensions failed:\n{done.stdout}")
