# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures of the stress tests, and a table of each test's bound and its largest measured value.

`assert_within` notes what it compares in the test's report, so the table is also complete under pytest-xdist.
"""

import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import pytest

TABLE_HEAD = "| case | comparisons | bound | largest |\n|---|---|---|---|"


@dataclass
class Row:
    """One bound of a test, and the largest of the values that were compared with it."""

    bound: float
    largest: float = 0.0
    comparisons: int = 0


#: Key of what `assert_within` notes among the user properties of a test's report.
COMPARISON = "comparison with a bound"


@pytest.fixture
def examples(request: pytest.FixtureRequest) -> int:
    """Number of random pictures that are drawn."""
    return request.config.getoption("--examples")


@pytest.fixture
def frames(request: pytest.FixtureRequest) -> int:
    """Number of animation frames that are compared with Cycles."""
    return request.config.getoption("--frames")


@pytest.fixture
def repetitions(request: pytest.FixtureRequest) -> int:
    """Number of renders, or of viewport updates, in a row."""
    return request.config.getoption("--rounds")


@pytest.fixture
def snapshot_path(tmp_path) -> Path:
    """The path of a valid snapshot."""
    from ism_addon import snapshot
    from tests.support.small_scenes import SMALL_SETTINGS

    from ..scenes.small import box_over_plane

    path = tmp_path / "scene.npz"
    snapshot.save(path, *box_over_plane(24, 16), SMALL_SETTINGS)
    return path


@pytest.fixture
def cli_error(monkeypatch, capsys) -> Callable[..., str]:
    """cli_error(arguments…): the one line that the command line prints when it fails with exit status 1."""

    from ism_addon.gpu import __main__ as command_line

    def cli_error(*arguments: object) -> str:
        monkeypatch.setattr(sys, "argv", ["ism_addon.gpu", *map(str, arguments)])
        assert command_line.main() == 1
        (line,) = capsys.readouterr().err.splitlines()
        return line

    return cli_error


@pytest.fixture
def assert_within(request: pytest.FixtureRequest) -> Callable[[float, float], None]:
    """assert_within(measured, bound): asserts measured ≤ bound, and notes both for the table."""
    name = title(request.node.name)

    def assert_within(measured: float, bound: float) -> None:
        request.node.user_properties.append((COMPARISON, (name, bound, float(measured))))
        assert measured <= bound, f"{name}: {measured:.3g} exceeds the bound {bound:.3g}"

    return assert_within


def title(name: str) -> str:
    """A test's name as a sentence, without its parameters."""
    return name.removeprefix("test_").partition("[")[0].replace("_", " ")


def table_rows(reports: Iterable[pytest.TestReport]) -> dict[str, Row]:
    """One row for each test and bound in the reports, keyed "name, bound"."""
    rows: dict[str, Row] = {}
    for report in reports:
        for name, bound, measured in (value for key, value in report.user_properties if key == COMPARISON):
            row = rows.setdefault(f"{name}, {bound:g}", Row(bound))
            row.largest, row.comparisons = max(row.largest, measured), row.comparisons + 1
    return rows


@pytest.hookimpl(trylast=True)
def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print the table, in Markdown."""
    if rows := table_rows([*terminalreporter.getreports("passed"), *terminalreporter.getreports("failed")]):
        terminalreporter.section("bounds, and the largest measured values")
        terminalreporter.write_line(TABLE_HEAD)
        for name, row in rows.items():
            case = name.rpartition(", ")[0]
            terminalreporter.write_line(f"| {case} | {row.comparisons} | {row.bound:g} | {row.largest:.2g} |")
