# SPDX-License-Identifier: GPL-3.0-or-later
"""Time and memory against what grows, log–log: a panel for each series."""

from collections.abc import Mapping
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from .report import COLUMNS, Results
from .series import SERIES

#: Columns of the report that are times, and how they are drawn.
TIMES = {
    "first sync s": ("#4477aa", "s"),
    "shadows ms": ("#ee6677", "o"),
    "trees kept: shadows ms": ("#ccbb44", "v"),
    "first sample s": ("#228833", "^"),
    "further sample s": ("#66ccee", "D"),
    "a frame s": ("#999999", "x"),
}
SECONDS = {"s": 1.0, "ms": 1e-3}
MEMORY = "peak MB"

#: Panels side by side.
ACROSS = 2


def draw(results: Mapping[str, Results], folder: Path) -> Path:
    """Write scale.png: its path."""
    rows = -(-len(results) // ACROSS)
    figure = Figure(figsize=(10.0, 3.0 * rows + 0.5), layout="constrained")
    panels = figure.subplots(rows, ACROSS, squeeze=False).ravel()
    drawn = {}
    for axis, (name, points) in zip(panels, results.items(), strict=False):
        values = list(points)
        for heading, (color, marker) in TIMES.items():
            found = [COLUMNS[heading](told) for told in points.values()]
            if any(found):
                label, unit = heading.rsplit(" ", 1)
                seconds = [SECONDS[unit] * time for time in found]
                drawn[label], *_ = axis.plot(values, seconds, color=color, marker=marker, markersize=4)
        memory = axis.twinx()
        peak = [COLUMNS[MEMORY](told) for told in points.values()]
        drawn["memory at most"], *_ = memory.plot(values, peak, ":", color="#aa3377")
        memory.set(yscale="log", ylim=(100.0, 10_000.0), ylabel="MB")
        axis.set(xscale="log", yscale="log", xlabel=SERIES[name].unit, ylabel="seconds")
        axis.xaxis.set(major_locator=FixedLocator(values), minor_locator=NullLocator(), major_formatter="{x:,.0f}")
        axis.grid(True, which="major", color="0.85", linewidth=0.6)
    for axis in panels[len(results) :]:
        axis.set_axis_off()
    figure.legend(drawn.values(), drawn.keys(), loc="outside upper center", ncols=len(drawn), fontsize=8)
    path = folder / "scale.png"
    figure.savefig(path, dpi=90)
    return path
