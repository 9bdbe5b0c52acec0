# SPDX-License-Identifier: GPL-3.0-or-later
"""Error against time, log–log: a small picture for each scene, and one of all."""

from collections.abc import Mapping
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

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
        figure = Figure(figsize=(5.2, 3.6), layout="constrained")
        panel(figure.subplots(), name, result.curves, result.facts["resolution of the error"])
        figure.axes[0].legend(fontsize=8)
        written.append(folder / f"error-{name}.svg")
        figure.savefig(written[-1])
    columns = min(len(results), 3)
    figure = Figure(figsize=(3.6 * columns, 2.9 * -(-len(results) // columns)), layout="constrained")
    axes = figure.subplots(-(-len(results) // columns), columns, squeeze=False).ravel()
    for axis, (name, result) in zip(axes, results.items(), strict=False):
        panel(axis, name, result.curves, result.facts["resolution of the error"])
    for axis in axes[len(results) :]:
        axis.set_axis_off()
    lines, names = axes[0].get_legend_handles_labels()
    figure.legend(lines, names, loc="outside lower center", ncols=min(len(names), 2 * columns), fontsize=9)
    written.append(folder / "error.png")
    figure.savefig(written[-1], dpi=110)
    return written


def panel(axis: Axes, name: str, curves: Curves, resolution: float, measure: str = "rmse") -> None:
    """One scene's curves; shaded is what the truth's own noise hides."""
    for engine, points in curves.items():
        color, marker, line = STYLES.get(engine, OURS)
        seconds = [point.seconds for point in points]
        errors = [getattr(point.error, measure) for point in points]
        axis.loglog(seconds, errors, color=color, marker=marker, linestyle=line, markersize=4, label=engine)
    axis.axhspan(0.2 * resolution, resolution, color="0.9", zorder=0)
    axis.set_title(name, fontsize=10)
    axis.set_xlabel("seconds", fontsize=8)
    axis.set_ylabel(NAMES[measure], fontsize=8)
    axis.tick_params(labelsize=8)
    axis.grid(True, which="major", color="0.85", linewidth=0.6)
