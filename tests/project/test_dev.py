# SPDX-License-Identifier: GPL-3.0-or-later
"""dev.py: what it installs and packs, and its messages about missing programs and wrong arguments."""

import os
import subprocess
import sys
import tomllib
import zipfile

import pytest

from tests.gui.scenario import scenarios
from tests.tools import blender_root, environments, machine, project


def dev(*arguments):
    command = [sys.executable, "dev.py", *arguments]
    return subprocess.run(command, cwd=project.ROOT, capture_output=True, text=True)


def test_every_package_has_one_exact_version():
    packages = [package for group in project.PACKAGES.values() for package in group]
    assert all("==" in package for package in packages)
    assert set(project.PACKAGES["gpu"]) == set(project.WHEELS["linux-x64"]["packages"])


def test_the_script_of_continuous_integration_is_executable():
    assert os.access(project.ROOT / ".ci" / "run", os.X_OK)


def test_an_unknown_argument_is_named():
    run = dev("extension", "--fast")
    assert run.returncode == 2
    assert "unknown: --fast" in run.stderr


def test_a_user_who_may_not_install_gets_the_command(monkeypatch):
    monkeypatch.setitem(machine.LIBRARIES, "libthere-is-none.so.1", "libthere-is-none1")
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    with pytest.raises(SystemExit) as exit:
        machine.prepare()
    command = "apt-get update && apt-get install --no-install-recommends libthere-is-none1"
    assert f"\n    sudo sh -c '{command}'\n" in exit.value.code


@pytest.mark.parametrize(
    ("program", "package"),
    [("glslangValidator", "glslang-tools"), ("git", "git"), ("lavapipe", "mesa-vulkan-drivers")],
)
def test_a_missing_program_is_installed_by_its_package(monkeypatch, tmp_path, program, package):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(machine, "VULKAN_DRIVERS", tmp_path)
    assert package in machine.missing_packages(program)


@pytest.mark.parametrize(
    ("blender", "sentence"),
    [(None, "there is no blender on the PATH"), ("echo versions 3 6 5 3 10", "too old"), ("false", "does not start")],
)
def test_a_python_without_bpy_gets_a_message_that_names_versions_with_bpy(monkeypatch, tmp_path, blender, sentence):
    if blender:
        (tmp_path / "blender").write_text(f"#!/bin/sh\n{blender}\n")
        (tmp_path / "blender").chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(environments, "PYTHON", "3.12")
    with pytest.raises(SystemExit) as exit:
        next(environments.environments())
    assert sentence in exit.value.code
    assert "Use Python 3.11 or 3.13" in exit.value.code


def test_an_unknown_scenario_is_named():
    run = dev("gui-test", "no_such_thing")
    assert run.returncode == 2
    assert "no scenario no_such_thing, but: switch_to_rendered" in run.stdout


def test_without_a_blender_with_a_window_gui_test_is_skipped_with_a_message(tmp_path):
    run = dev("gui-test", "--blender", str(tmp_path / "blender"))
    assert run.returncode == 77
    assert "Not tested in a real Blender: there is no program" in run.stdout


def test_a_root_folder_can_be_installed_by_root_only(monkeypatch, tmp_path):
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    with pytest.raises(blender_root.Missing, match="by root only"):
        blender_root.install(tmp_path)


def test_every_scenario_has_a_name_and_a_description():
    found = scenarios()
    assert len({scenario.name for scenario in found}) == len(found) > 10
    assert all(scenario.about.endswith(".") for scenario in found)


@pytest.fixture(scope="module")
def archives(tmp_path_factory):
    """The zip that dev.py makes for each platform."""
    folder = tmp_path_factory.mktemp("extension")
    run = dev("extension", "--output", str(folder))
    assert run.returncode == 0, run.stdout + run.stderr
    return {platform: next(folder.glob(f"*{platform.replace('-', '_')}.zip")) for platform in project.WHEELS}


@pytest.mark.parametrize("platform", project.WHEELS)
def test_a_zip_holds_the_addon_and_its_platforms_wheels(archives, platform):
    with zipfile.ZipFile(archives[platform]) as archive:
        names = set(archive.namelist())
        manifest = tomllib.loads(archive.read("blender_manifest.toml").decode())
    wheels = {name for name in names if name.startswith("wheels/")}
    contents = project.WHEELS[platform]
    assert len(wheels) == len(contents["python"]) * len(contents["packages"])
    assert wheels == {name.removeprefix("./") for name in manifest["build"]["generated"]["wheels"]}
    addon = {name for name in project.files() if name.startswith("ism_addon/")}
    assert names - wheels - {"README.md"} == addon | {"__init__.py", "blender_manifest.toml", "CHANGELOG.md", "LICENSE"}


def test_the_version_is_in_the_changelog():
    manifest = tomllib.loads((project.ROOT / "blender_manifest.toml").read_text("utf-8"))
    assert f"\n## {manifest['version']}\n" in (project.ROOT / "CHANGELOG.md").read_text("utf-8")
