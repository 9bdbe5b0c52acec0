# SPDX-License-Identifier: GPL-3.0-or-later
"""How far cases may be off, and how far they are: `within` asserts it, and the table at the end shows it.

What it shows comes with the tests' reports, as those of several processes do. And how many are drawn, a snapshot, and
the command line, for tests of several files.
"""

import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import pytest

HEAD = "| case | tried | may be | is |\n|---|---|---|---|"


@dataclass
class Row:
    """Of a test: how far it may be off, and how far it is at worst over the cases tried."""

    bound: float
    worst: float = 0.0
    tried: int = 0


#: The name of what `within` notes, among the properties of a test's report.
OFF = "how far off"


@pytest.fixture
def examples(request: pytest.FixtureRequest) -> int:
    """How many random pictures are drawn."""
    return request.config.getoption("--examples")


@pytest.fixture
def frames(request: pytest.FixtureRequest) -> int:
    """How many frames of animations are drawn beside Cycles."""
    return request.config.getoption("--frames")


@pytest.fixture
def rounds(request: pytest.FixtureRequest) -> int:
    """How many renders there are in a row."""
    return request.config.getoption("--rounds")


@pytest.fixture
def path(tmp_path) -> Path:
    """A snapshot's file."""
    from ism_addon import snapshot
    from tests.support.small_scenes import SMALL_SETTINGS

    from ..scenes.small import box_over_plane

    path = tmp_path / "scene.npz"
    snapshot.save(path, *box_over_plane(24, 16), SMALL_SETTINGS)
    return path


@pytest.fixture
def told(monkeypatch, capsys) -> Callable[..., str]:
    """told(arguments…): what the command line says of what it refuses."""

    from ism_addon.gpu import __main__ as command_line

    def told(*arguments: object) -> str:
        monkeypatch.setattr(sys, "argv", ["ism_addon.gpu", *map(str, arguments)])
        assert command_line.main() == 1
        (line,) = capsys.readouterr().err.splitlines()
        return line

    return told


@pytest.fixture
def within(request: pytest.FixtureRequest) -> Callable[[float, float], None]:
    """within(is, may_be): asserts it, and notes it for the table."""
    name = title(request.node.name)

    def within(measured: float, bound: float) -> None:
        request.node.user_properties.append((OFF, (name, bound, float(measured))))
        assert measured <= bound, f"{name}: {measured:.3g}, may be {bound:.3g}"

    return within


def title(name: str) -> str:
    """A test's name as a sentence, without its parameters."""
    return name.removeprefix("test_").partition("[")[0].replace("_", " ")


def rows(reports: Iterable[pytest.TestReport]) -> dict[str, Row]:
    """Of the tests that noted something: all that they noted."""
    rows: dict[str, Row] = {}
    for report in reports:
        for name, bound, measured in (value for key, value in report.user_properties if key == OFF):
            row = rows.setdefault(f"{name}, {bound:g}", Row(bound))
            row.worst, row.tried = max(row.worst, measured), row.tried + 1
    return rows


@pytest.hookimpl(trylast=True)
def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """The table in Markdown."""
    if found := rows([*terminalreporter.getreports("passed"), *terminalreporter.getreports("failed")]):
        terminalreporter.section("how far off cases may be, and are at worst")
        terminalreporter.write_line(HEAD)
        for name, row in found.items():
            case = name.rpartition(", ")[0]
            terminalreporter.write_line(f"| {case} | {row.tried} | {row.bound:g} | {row.worst:.2g} |")
