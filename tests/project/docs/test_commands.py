# SPDX-License-Identifier: GPL-3.0-or-later
"""Every command and script in the documentation does what it says, or at least is one that its program knows."""

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
from tests.demo import steps
from tests.docs.commands import Command, commands, other_languages, scripts
from tests.scenes.small import box_over_plane
from tests.support.small_scenes import SMALL_SETTINGS
from tests.tools import machine, project

COMMANDS = list(commands())
#: Blender's own options that the documentation may name: its module cannot tell them. As in `blender --help`.
BLENDER = {"--background", "--python", "--command", "--engine", "--factory-startup"} | {
    f"--render-{what}" for what in ("output", "anim", "frame")
}


def of(*beginning: str) -> list[Command]:
    return [command for command in COMMANDS if tuple(command.words[: len(beginning)]) == beginning]


DEV, PYTHON = of("python3", "dev.py"), [*of("python3", "-m", "ism_addon.gpu"), *of("python", "-m", "ism_addon.gpu")]
STEPS = of("python3", "-m", "tests.demo.steps")
INSTALL, EXTENSION, QUESTIONS = of("apt-get"), of("blender", "--command", "extension"), of("python3", "-c")
BLENDERS = [command for command in of("blender") if command not in EXTENSION]


@cache
def help_of(module: str, *arguments: str) -> str:
    """What a module's main prints when it is asked for help."""
    main, told = importlib.import_module(module).main, io.StringIO()
    words = [module, *arguments, "--help"]
    with mock.patch.object(sys, "argv", words), redirect_stdout(told), pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 0
    return told.getvalue()


def main_of(benchmark: str) -> str:
    """The module that runs a benchmark."""
    module = f"tests.benchmark.{benchmark}"
    return f"{module}.__main__" if hasattr(importlib.import_module(module), "__path__") else module


def test_each_command_is_of_a_kind_that_is_tried_here():
    tried = [*DEV, *STEPS, *PYTHON, *INSTALL, *EXTENSION, *QUESTIONS, *BLENDERS]
    assert [str(command) for command in COMMANDS if command not in tried] == []
    assert other_languages() == set()


@pytest.mark.parametrize("command", DEV, ids=str)
def test_dev_knows_it(command):
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


@pytest.mark.parametrize("command", PYTHON, ids=str)
def test_the_command_line_draws(command, tmp_path):
    snapshot.save(tmp_path / "scene.npz", *box_over_plane(24, 16), SMALL_SETTINGS)
    arguments = command.words[3:] or ["--help"]
    run = [sys.executable, "-m", "ism_addon.gpu", *arguments]
    environment = os.environ | {"PYTHONPATH": str(project.ROOT)}
    done = subprocess.run(run, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stderr) == (0, "")
    if "-o" in arguments:
        assert (tmp_path / arguments[arguments.index("-o") + 1]).stat().st_size > 100


@pytest.mark.parametrize("command", STEPS, ids=str)
def test_the_pictures_of_the_method_have_a_command(command):
    assert command.options - {"-m"} <= set(help_of(command.words[2]).split())
    assert not [
        step for step in steps.SAMPLES if not (project.ROOT / "docs" / "pictures" / steps.file_name(step)).exists()
    ]


@pytest.mark.skipif(sys.platform != "linux", reason="they ask EGL")
@pytest.mark.parametrize("command", QUESTIONS, ids=str)
def test_a_question_is_answered(command):
    done = subprocess.run([sys.executable, *command.words[1:]], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip()


@pytest.mark.parametrize("command", INSTALL, ids=str)
def test_packages_to_install_are_those_that_we_need(command):
    packages = {word for word in command.words[2:] if not word.startswith("-")}
    assert packages <= set(machine.LIBRARIES.values())


@pytest.mark.parametrize("command", EXTENSION, ids=str)
def test_blenders_tool_for_extensions_knows_it(command, monkeypatch):
    monkeypatch.syspath_prepend(str(Path(bpy.utils.system_resource("SCRIPTS")) / "addons_core"))
    from bl_pkg.bl_extension_cli import cli_extension_handler

    told = io.StringIO()
    with redirect_stdout(told), pytest.raises(SystemExit) as end:
        cli_extension_handler([command.words[3], "--help"])
    assert end.value.code == 0
    assert all(option in told.getvalue() for option in command.options - {"--command"})


@pytest.mark.parametrize("command", BLENDERS, ids=str)
def test_blender_has_these_options(command):
    assert command.options - {"-b"} <= BLENDER


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
    """The README's script, as it stands, at its own size: brighter in the cube's light than the world is."""
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
