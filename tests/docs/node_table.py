# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of shader nodes in docs/benchmarks.md: the error of the worst case of each."""

from collections.abc import Mapping

from tests.benchmark.error.report import table

from . import record


def by_node(errors: Mapping[str, float]) -> dict[str, dict[str, float]]:
    """The cases of each node, the worst first."""
    nodes: dict[str, dict[str, float]] = {}
    for name, error in sorted(errors.items(), key=lambda pair: -pair[1]):
        nodes.setdefault(name.split()[0], {})[name.partition(" ")[2]] = error
    return dict(sorted(nodes.items()))


def rows(errors: Mapping[str, float]) -> str:
    """A row for each node."""
    lines = [["node", "cases", "RMSE at most", "of"]]
    for node, cases in by_node(errors).items():
        worst, error = next(iter(cases.items()))
        lines.append([node, str(len(cases)), f"{error:.4f}", worst])
    return table(lines)


def node_table() -> str:
    """The table, and its origin."""
    recorded = record.read("nodes")
    return f"{rows(recorded['rmse'])}\n\n{record.sentence(recorded)}"
