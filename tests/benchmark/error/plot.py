# SPDX-License-Identifier: GPL-3.0-or-later
"""Error against time, log–log: a small picture for each scene, one of all; shaded is what the truth's noise hides."""

import math
from collections.abc import Mapping
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, StrMethodFormatter

from .race import Result
from .report import NAMES, Curves

#: Colour, marker and line of each engine; what is not named here is ours.
STYLES = {
    "Cycles": ("#4477aa", "s", "-"),
    "Cycles + OIDN": ("#66ccee", "D", "--"),
    "EEVEE": ("#999999", "^", ":"),
    "ISM classic": ("#ccbb44", "v", "-."),
}
OURS = ("#ee6677", "o", "-")


def draw(results: Mapping[str, Result], folder: Path) -> list[Path]:
    """Write error-SCENE.svg for each scene and error.png of all: their paths."""
    written = []
    for name, result in results.items():
        figure = figure_of({name: result}, columns=1, panel=(5.2, 3.6))
        written.append(folder / f"error-{name}.svg")
        figure.savefig(written[-1])
    figure = figure_of(results, columns=min(len(results), 3), panel=(3.6, 3.1))
    written.append(folder / "error.png")
    figure.savefig(written[-1], dpi=110)
    return written


def figure_of(results: Mapping[str, Result], columns: int, panel: tuple[float, float]) -> Figure:
    """A panel for each scene, `panel` inches large, all with the same axes."""
    rows = -(-len(results) // columns)
    figure = Figure(figsize=(panel[0] * columns, panel[1] * rows), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).ravel()
    for axis, (name, result) in zip(axes, results.items(), strict=False):
        draw_curves(axis, name, result.curves)
    bottom, top = axes[0].get_ylim()
    for axis, result in zip(axes, results.values(), strict=False):
        axis.axhspan(bottom / 10.0, max(result.facts["resolution of the error"], bottom / 10.0), color="0.9", zorder=0)
    axes[0].set_ylim(bottom, top)
    for axis in axes[len(results) :]:
        axis.set_axis_off()
    lines, names = axes[0].get_legend_handles_labels()
    figure.legend(lines, names, loc="outside lower center", ncols=min(len(names), 2 * columns), fontsize=9)
    return figure


def draw_curves(axis: Axes, name: str, curves: Curves, measure: str = "rmse") -> None:
    """One scene's curves."""
    for engine, points in curves.items():
        color, marker, line = STYLES.get(engine, OURS)
        seconds = [point.seconds for point in points]
        errors = [getattr(point.error, measure) or math.nan for point in points]  # 0 was lost in the truth's noise
        axis.loglog(seconds, errors, color=color, marker=marker, linestyle=line, markersize=4, label=engine)
    axis.set_title(name, fontsize=10)
    axis.set_xlabel("seconds", fontsize=8)
    axis.set_ylabel(NAMES[measure], fontsize=8)
    axis.tick_params(labelsize=8)
    for scale in (axis.xaxis, axis.yaxis):
        scale.set_major_formatter(StrMethodFormatter("{x:g}"))
        scale.set_minor_formatter(NullFormatter())
    axis.grid(True, which="major", color="0.85", linewidth=0.6)
