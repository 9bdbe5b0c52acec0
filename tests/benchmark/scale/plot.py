# SPDX-License-Identifier: GPL-3.0-or-later
"""Time and memory against what grows, log–log: a row of two panels for each series."""

from collections.abc import Mapping
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .report import COLUMNS, Results
from .series import SERIES

#: Columns of the report in seconds, and how they are drawn.
TIMES = {
    "first sync s": ("#4477aa", "s", 1.0),
    "shadows ms": ("#ee6677", "o", 1e-3),
    "trees kept: shadows ms": ("#ccbb44", "v", 1e-3),
    "first sample s": ("#228833", "^", 1.0),
    "further sample s": ("#66ccee", "D", 1.0),
    "a frame s": ("#999999", "x", 1.0),
}


def draw(results: Mapping[str, Results], folder: Path) -> Path:
    """Write scale.png: its path."""
    figure = Figure(figsize=(9.0, 2.9 * len(results)), layout="constrained")
    axes = figure.subplots(len(results), 2, squeeze=False)
    for (left, right), (name, points) in zip(axes, results.items(), strict=True):
        for heading, (color, marker, unit) in TIMES.items():
            values = {value: COLUMNS[heading](told) for value, told in points.items()}
            known = {value: unit * found for value, found in values.items() if found}
            left.loglog(list(known), list(known.values()), color=color, marker=marker, markersize=4, label=heading[:-3])
        right.loglog(list(points), [COLUMNS["peak MB"](told) for told in points.values()], "o-", color="#aa3377")
        label(left, name, "seconds")
        label(right, name, "peak MB")
        left.legend(fontsize=7)
    path = folder / "scale.png"
    figure.savefig(path, dpi=110)
    return path


def label(axis: Axes, name: str, what: str) -> None:
    """What the axes are, and a grid."""
    axis.set_xlabel(SERIES[name].unit, fontsize=8)
    axis.set_ylabel(what, fontsize=8)
    axis.tick_params(labelsize=8)
    axis.grid(True, which="major", color="0.85", linewidth=0.6)
