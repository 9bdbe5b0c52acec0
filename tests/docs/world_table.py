# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of worlds in docs/benchmarks.md: the errors of their light on surfaces that nothing shadows."""

from collections.abc import Mapping

from tests.benchmark.error.report import table

from . import record

#: By world and surface: "error" and "noise" of blocks' means, "rmse", and each reference's samples, "truth".
Worlds = Mapping[str, Mapping[str, Mapping[str, float]]]

#: The error that all worlds have to be within.
BOUND = 0.003


def rows(worlds: Worlds) -> str:
    """A row for each world: the median error of the blocks of each surface, in %, and that of Cycles' noise."""
    lines = [["median of blocks, % (noise of Cycles)", *next(iter(worlds.values())), "samples of Cycles"]]
    for name, surfaces in worlds.items():
        errors = [f"{100.0 * each['error']:.3f} ({100.0 * each['noise']:.3f})" for each in surfaces.values()]
        lines.append([name, *errors, f"{max(2 * each['truth'] for each in surfaces.values()):,}"])
    return table(lines)


def world_table() -> str:
    """The table, and its origin."""
    recorded = record.read("worlds")
    return f"{rows(recorded['worlds'])}\n\n{record.sentence(recorded)}"
