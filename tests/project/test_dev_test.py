# SPDX-License-Identifier: GPL-3.0-or-later
"""What `dev.py test` runs, in which environments, and what it reports."""

import json
import sys

import pytest

import dev
from tests.tools.environments import Environment

#: Replaces `python -m`: logs its arguments, and exits with the status that EXIT_OF_module has.
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
    """run(arguments after `test`): the exit status, the commands by environment, and `any_pace` of each window test."""
    (tmp_path / "recorder.py").write_text(RECORDER)
    log, window_tests, installed = tmp_path / "log", [], []

    def environment(name: str, has_processes: bool = True) -> Environment:
        start = sys.executable, str(tmp_path / "recorder.py"), str(log), name
        return Environment(name, tmp_path, start, (), has_processes=has_processes)

    def play(names: list, program: None, root: object, output: object, any_pace: bool) -> int:
        window_tests.append(any_pace)
        return dev.SKIPPED

    monkeypatch.setattr(dev, "gui_test", play)
    monkeypatch.setattr(dev.blender_root, "install", installed.append)

    def run(*arguments: str, in_blender: bool = False) -> tuple[int, list[list[str]], list[bool]]:
        prepared = [environment("first", not in_blender), environment("second")]
        monkeypatch.setattr(dev, "environments", lambda: iter(prepared))
        monkeypatch.setattr(dev, "all_environments", lambda _pool: iter(prepared))
        monkeypatch.setattr(sys, "argv", ["dev.py", "test", *arguments])
        log.write_text("")
        window_tests.clear()
        installed.clear()
        status = dev.main()
        assert installed == [dev.BLENDER_ROOT] * len(window_tests)
        return status, [json.loads(line) for line in log.read_text().splitlines()], window_tests

    return run


def test_by_default_it_checks_style_types_and_tests_with_one_bpy(run, capsys):
    status, commands, window_tests = run()
    assert (status, window_tests) == (0, [])
    assert {where for where, *_ in commands} == {"first"}
    checks = {" ".join(command) for _, *command in commands if command[0] != "pytest"}
    assert checks == {"ruff check", "ruff format --check", "mypy"}
    tests = [command for _, module, *command in commands if module == "pytest"]
    assert ["-n=auto" in command for command in tests] == [True, False]
    assert ["-m=alone" in command for command in tests] == [False, True]
    assert all("--ignore=tests/stress" in command for command in tests)
    assert "passed: ruff, ruff's format, mypy, first, first, one by one\n" in capsys.readouterr().out


def test_inside_a_blender_tests_run_in_one_process_and_mypy_does_not(run):
    status, commands, _ = run(in_blender=True)
    assert status == 0
    expected = [["ruff", "check"], ["ruff", "format", "--check"], ["pytest", "--ignore=tests/stress"]]
    assert sorted(commands) == sorted(["first", *command] for command in expected)


def test_all_adds_the_stress_tests_the_other_releases_of_bpy_and_the_window(run, capsys):
    status, commands, window_tests = run("--all", "--any-pace")
    assert (status, window_tests) == (0, [True])
    assert not any("--ignore=tests/stress" in command for command in commands)
    (other,) = [command for where, _, *command in commands if where == "second"]
    assert "--override-ini=testpaths=tests/blender" in other
    assert "-m=not alone and not any_release" in other
    assert "not tried: the window\n" in capsys.readouterr().out


def test_the_window_test_is_timed_by_default(run):
    assert run("--all")[2] == [False]


@pytest.mark.parametrize(("flags", "where"), [([], ["first"]), (["--all"], ["first", "second"])])
def test_chosen_tests_are_run_without_other_checks(run, flags, where):
    status, commands, window_tests = run(*flags, "-k", "name", "--all-of-them")
    assert (status, window_tests) == (0, [])
    assert [command[0] for command in commands] == where
    assert all(command[-3:] == ["-k", "name", "--all-of-them"] for command in commands)


@pytest.mark.parametrize("module", ["ruff", "mypy", "pytest"])
def test_failed_checks_are_named(run, monkeypatch, capsys, module):
    monkeypatch.setenv(f"EXIT_OF_{module}", "1")
    assert run()[0] == 1
    names = {"ruff": "ruff, ruff's format", "mypy": "mypy", "pytest": "first, first, one by one"}
    assert f"failed: {names[module]}\n" in capsys.readouterr().out


def test_choosing_no_test_is_a_failure(run, monkeypatch):
    monkeypatch.setenv("EXIT_OF_pytest", str(dev.NO_TEST_WAS_CHOSEN))
    assert run("-k", "no_such_test")[0] == 1
