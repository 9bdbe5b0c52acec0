# SPDX-License-Identifier: GPL-3.0-or-later
"""Every command and script in the documentation runs, or at least its program knows its options."""

import importlib
import io
import os
import subprocess
import sys
from contextlib import redirect_stdout
from functools import cache
from pathlib import Path
from unittest import mock

import bpy
import pytest

from ism_addon import addon, snapshot
from tests.demo import sponza, steps
from tests.docs.commands import Command, commands, other_languages, scripts
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import SMALL_SETTINGS
from tests.tools import machine, project

COMMANDS = list(commands())
#: Options of `blender --help` that the documentation may use. They are listed because bpy does not give them.
BLENDER_OPTIONS = {"--background", "--python", "--command", "--engine", "--factory-startup"} | {
    f"--render-{what}" for what in ("output", "anim", "frame")
}


def beginning_with(*words: str) -> list[Command]:
    return [command for command in COMMANDS if tuple(command.words[: len(words)]) == words]


DEV = beginning_with("python3", "dev.py")
COMMAND_LINE = [*beginning_with("python3", "-m", "ism_addon.gpu"), *beginning_with("python", "-m", "ism_addon.gpu")]
STEPS = [*beginning_with("python3", "-m", "tests.demo.steps"), *beginning_with("python3", "-m", "tests.demo.sponza")]
INSTALL, ONE_LINERS = beginning_with("apt-get"), beginning_with("python3", "-c")
EXTENSION = beginning_with("blender", "--command", "extension")
BLENDER = [command for command in beginning_with("blender") if command not in EXTENSION]


@cache
def help_of(module: str, *arguments: str) -> str:
    """What a module's main prints for --help."""
    main, output = importlib.import_module(module).main, io.StringIO()
    words = [module, *arguments, "--help"]
    with mock.patch.object(sys, "argv", words), redirect_stdout(output), pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 0
    return output.getvalue()


def main_of(benchmark: str) -> str:
    """The module that runs a benchmark."""
    module = f"tests.benchmark.{benchmark}"
    return f"{module}.__main__" if hasattr(importlib.import_module(module), "__path__") else module


def test_every_command_is_tested_here():
    tested = [*DEV, *STEPS, *COMMAND_LINE, *INSTALL, *EXTENSION, *ONE_LINERS, *BLENDER]
    assert [str(command) for command in COMMANDS if command not in tested] == []
    assert other_languages() == set()


@pytest.mark.parametrize("command", DEV, ids=str)
def test_dev_knows_the_command(command):
    verb, *rest = command.words[2:]
    text = help_of("dev", verb)
    if verb == "bench":
        text += help_of(main_of(rest[0]))
    elif verb == "demo":
        text += help_of("tests.demo.figure6")
    elif verb == "docs":
        assert all((project.ROOT / "docs" / "records" / f"{name}.json").exists() for name in rest)
    elif verb == "test":
        assert all((project.ROOT / name).exists() for name in rest if not name.startswith("-"))
    assert all(option in text for option in command.options)


@pytest.mark.parametrize("command", COMMAND_LINE, ids=str)
def test_the_command_line_draws(command, tmp_path):
    snapshot.save(tmp_path / "scene.npz", *box_over_plane(24, 16), SMALL_SETTINGS)
    arguments = command.words[3:] or ["--help"]
    line = [sys.executable, "-m", "ism_addon.gpu", *arguments]
    environment = os.environ | {"PYTHONPATH": str(project.ROOT)}
    run = subprocess.run(line, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=120)
    assert (run.returncode, run.stderr) == (0, "")
    if "-o" in arguments:
        assert (tmp_path / arguments[arguments.index("-o") + 1]).stat().st_size > 100


@pytest.mark.parametrize("command", STEPS, ids=str)
def test_the_pictures_of_the_method_have_a_command(command):
    assert command.options - {"-m"} <= set(help_of(command.words[2]).split())
    files = [*map(steps.file_name, steps.SAMPLES), *(f"{figure}.jpg" for figure in sponza.FIGURES)]
    assert not [file for file in files if not (project.ROOT / "docs" / "pictures" / file).exists()]


@pytest.mark.skipif(sys.platform != "linux", reason="they use EGL")
@pytest.mark.parametrize("command", ONE_LINERS, ids=str)
def test_python_one_liners_print_a_result(command):
    run = subprocess.run([sys.executable, *command.words[1:]], capture_output=True, text=True, timeout=60)
    assert run.returncode == 0, run.stderr
    assert run.stdout.strip()


@pytest.mark.parametrize("command", INSTALL, ids=str)
def test_packages_to_install_are_those_that_are_needed(command):
    packages = {word for word in command.words[2:] if not word.startswith("-")}
    assert packages <= set(machine.LIBRARIES.values())


@pytest.mark.parametrize("command", EXTENSION, ids=str)
def test_blenders_tool_for_extensions_knows_the_command(command, monkeypatch):
    monkeypatch.syspath_prepend(str(Path(bpy.utils.system_resource("SCRIPTS")) / "addons_core"))
    from bl_pkg.bl_extension_cli import cli_extension_handler

    output = io.StringIO()
    with redirect_stdout(output), pytest.raises(SystemExit) as end:
        cli_extension_handler([command.words[3], "--help"])
    assert end.value.code == 0
    assert all(option in output.getvalue() for option in command.options - {"--command"})


@pytest.mark.parametrize("command", BLENDER, ids=str)
def test_blender_has_these_options(command):
    assert command.options - {"-b"} <= BLENDER_OPTIONS


@pytest.mark.parametrize(("page", "script"), scripts().items(), ids=scripts())
def test_scripts_run(page, script, tmp_path, monkeypatch):
    """In Blender's default scene, whose light is an area light, at a small size."""
    monkeypatch.chdir(tmp_path)
    bpy.ops.wm.read_factory_settings()
    addon.register()
    try:
        bpy.data.objects["Light"].data.type = "AREA"
        render = bpy.context.scene.render
        render.resolution_x, render.resolution_y = 48, 32
        exec(compile(script, page, "exec"), {"__name__": "__main__"})
    finally:
        addon.unregister()
    assert list(tmp_path.glob("*.png"))
    assert ("save_snapshot" in script) == (tmp_path / "scene.npz").exists()


def test_the_first_render_shows_the_cube_in_light(tmp_path, monkeypatch):
    """The README's script at a tenth of its resolution: the lit cube is much brighter than the darkest pixel."""
    monkeypatch.chdir(tmp_path)
    bpy.ops.wm.read_factory_settings()
    addon.register()
    try:
        bpy.context.scene.render.resolution_percentage = 10
        exec(compile(scripts()["README.md"], "README.md", "exec"), {"__name__": "__main__"})
    finally:
        addon.unregister()
    image = bpy.data.images.load(str(tmp_path / "first.png"))
    brightest, darkest = max(image.pixels[:]), min(image.pixels[:])
    assert brightest - darkest > 0.3
