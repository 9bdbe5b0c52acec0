# SPDX-License-Identifier: GPL-3.0-or-later
"""What `dev.py test` runs, in which environments, and what it says of it."""

import json
import sys

import pytest

import dev
from tests.tools.environments import Environment

#: Stands where `python -m` would: writes down what it should run, and exits as it is told for that module.
RECORDER = """
import json, os, sys
module, *arguments = sys.argv[3:]
with open(sys.argv[1], "a") as log:
    json.dump([sys.argv[2], module, *arguments], log)
    log.write("\\n")
sys.exit(int(os.environ.get(f"EXIT_OF_{module}", 0)))
"""


@pytest.fixture
def run(monkeypatch, tmp_path):
    """run(command line after `test`): its exit status, the commands by environment, and those that played a window."""
    (tmp_path / "recorder.py").write_text(RECORDER)
    log, windows, installed = tmp_path / "log", [], []

    def environment(name: str, has_processes: bool = True) -> Environment:
        start = sys.executable, str(tmp_path / "recorder.py"), str(log), name
        return Environment(name, tmp_path, start, (), has_processes=has_processes)

    def play(names: list, program: None, root: object, output: object, any_pace: bool) -> int:
        windows.append(any_pace)
        return dev.SKIPPED

    monkeypatch.setattr(dev, "gui_test", play)
    monkeypatch.setattr(dev.blender_root, "install", installed.append)

    def run(*arguments: str, in_blender: bool = False) -> tuple[int, list[list[str]], list[bool]]:
        every = [environment("first", not in_blender), environment("second")]
        monkeypatch.setattr(dev, "environments", lambda: iter(every))
        monkeypatch.setattr(dev, "all_environments", lambda: every)
        monkeypatch.setattr(sys, "argv", ["dev.py", "test", *arguments])
        log.write_text("")
        windows.clear()
        installed.clear()
        status = dev.main()
        assert installed == [dev.BLENDER_ROOT] * len(windows)
        return status, [json.loads(line) for line in log.read_text().splitlines()], windows

    return run


def test_one_bpy_the_style_and_the_types(run, capsys):
    status, commands, windows = run()
    assert (status, windows) == (0, [])
    assert {where for where, *_ in commands} == {"first"}
    assert [" ".join(command) for _, *command in commands][:3] == ["ruff check", "ruff format --check", "mypy"]
    tests = [command for _, module, *command in commands if module == "pytest"]
    assert ["-n=auto" in command for command in tests] == [True, False]
    assert ["-m=alone" in command for command in tests] == [False, True]
    assert "passed: ruff, ruff's format, mypy, first, first, one by one\n" in capsys.readouterr().out


def test_inside_a_blender_tests_run_in_one_process_and_mypy_does_not(run):
    status, commands, _ = run(in_blender=True)
    assert status == 0
    assert commands == [["first", "ruff", "check"], ["first", "ruff", "format", "--check"], ["first", "pytest"]]


def test_all_adds_the_other_bpys_and_the_window(run, capsys):
    status, commands, windows = run("--all", "--any-pace")
    assert (status, windows) == (0, [True])
    others = [command for where, _, *command in commands if where == "second"]
    assert len(others) == 2
    assert all("--override-ini=testpaths=tests/blender" in command for command in others)
    assert "not tried: the window\n" in capsys.readouterr().out


def test_the_window_has_its_pace_where_none_is_told(run):
    assert run("--all")[2] == [False]


@pytest.mark.parametrize(("flags", "where"), [([], ["first"]), (["--all"], ["first", "second"])])
def test_chosen_tests_are_run_alone(run, flags, where):
    status, commands, windows = run(*flags, "-k", "name", "--all-of-them")
    assert (status, windows) == (0, [])
    assert [command[0] for command in commands] == where
    assert all(command[-3:] == ["-k", "name", "--all-of-them"] for command in commands)


@pytest.mark.parametrize("module", ["ruff", "mypy", "pytest"])
def test_what_fails_is_named(run, monkeypatch, capsys, module):
    monkeypatch.setenv(f"EXIT_OF_{module}", "1")
    assert run()[0] == 1
    names = {"ruff": "ruff, ruff's format", "mypy": "mypy", "pytest": "first, first, one by one"}
    assert f"failed: {names[module]}\n" in capsys.readouterr().out


def test_choosing_none_is_a_failure(run, monkeypatch):
    monkeypatch.setenv("EXIT_OF_pytest", str(dev.NO_TEST_WAS_CHOSEN))
    assert run("-k", "no_such_test")[0] == 1
