# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension as users get it: built by dev.py, and installed from its zip into a Blender with no user settings."""

import json
import os
import subprocess
import sys
from pathlib import Path

import bpy
import pytest

from tests.tools import project

PLATFORM = {"linux": "linux-x64", "win32": "windows-x64", "darwin": "macos-arm64"}[sys.platform]
SCRIPT = Path(__file__).with_name("installed_extension.py")


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    """The zip for this machine."""
    folder = tmp_path_factory.mktemp("extension")
    command = [sys.executable, "dev.py", "extension", "--platform", PLATFORM, "--output", str(folder)]
    subprocess.run(command, cwd=project.ROOT, check=True)
    (path,) = folder.glob("*.zip")
    return path


@pytest.fixture(scope="module")
def report(archive):
    """The report of a Blender that installed the zip and rendered with it."""
    program = [sys.executable]
    if bpy.app.binary_path:
        program = [bpy.app.binary_path, "--background", "--python-exit-code", "1", "--python"]
    command = [*program, str(SCRIPT), "--", str(archive), str(archive.with_name("picture.png"))]
    user = archive.with_name("user")
    user.mkdir()
    environment = {**os.environ, "BLENDER_USER_RESOURCES": str(user)}
    environment.pop("PYTHONPATH", None)
    run = subprocess.run(command, env=environment, cwd=user, capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stdout + run.stderr
    assert "Traceback" not in run.stdout + run.stderr, run.stdout + run.stderr
    return next(json.loads(line) for line in run.stdout.splitlines() if line.startswith("{"))


def test_enabling_it_imports_no_opengl(report):
    assert report["packages before the first picture"] == []


def test_enabling_it_imports_nothing_that_reads_scenes(report):
    assert report["readers before the first picture"] == []


def test_enabling_it_starts_no_render_thread_and_so_compiles_no_shader(report):
    assert "ISM renderer" not in report["threads before the first picture"]


def test_it_brings_its_own_moderngl(report):
    assert Path(report["moderngl"]).is_relative_to(report["user"])


def test_it_renders_a_picture(report):
    assert report["size"] == [48, 32]
    assert report["brightest"] > report["darkest"] + 0.1
