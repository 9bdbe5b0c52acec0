# SPDX-License-Identifier: GPL-3.0-or-later
"""The error benchmark's tables in Markdown: all points of each scene, and a summary."""

import math
from collections.abc import Mapping, Sequence

from .curve import Point, error_at, time_to
from .measure import Result
from .metrics import EPSILON

Curves = Mapping[str, Sequence[Point]]  # by engine

GOAL = 0.05  # RMSE/mean: the time to this error is compared
BUDGETS = (0.3, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0, 20.0)  # s
BASELINES = ("Cycles", "Cycles + OIDN")
NAMES = {"rmse": "RMSE/mean", "relmse": "relMSE"}
COUNTED = (
    "Counted is what a further picture of an open scene costs: all passes of all samples, or Cycles' sampling and "
    "denoising from its first sample on. Not counted: start-up, reading the scene, BVH, shaders (see each scene). "
    f"RMSE and relMSE (ε = {EPSILON:g} of the squared mean) are free of the truth's noise, which is in the two halves "
    "of the reference; the 99th percentile of |error|/mean and FLIP are not. Medians of the rounds."
)


def summary(results: Mapping[str, Result], ours: Sequence[str]) -> str:
    """Tables of times and errors of each of our variants beside Cycles, and what is counted."""
    scenes = {name: result.curves for name, result in results.items()}
    tables = [
        table for name in ours for table in (goal_table(scenes, name), *(budget_table(scenes, name, m) for m in NAMES))
    ]
    missing = {f"{engine} did not run: {why}." for result in results.values() for engine, why in result.missing.items()}
    return "\n\n".join([*tables, COUNTED, *sorted(missing)])


def scene(name: str, result: Result) -> str:
    """One scene's facts, points and uncounted times."""
    facts = ", ".join(f"{fact} {format_number(value)}" for fact, value in result.facts.items())
    uncounted = [
        f"- {engine}: " + ", ".join(f"{what} {format_number(value)}" for what, value in values.items())
        for engine, values in result.uncounted.items()
    ]
    return "\n\n".join([f"## {name}", facts, scene_table(result.curves), "Not counted:\n" + "\n".join(uncounted)])


def scene_table(curves: Curves) -> str:
    """A row for each engine and number of samples."""
    rows = [["engine", "samples", "s", "RMSE/mean", "relMSE", "99 %", "FLIP"]]
    for name, points in curves.items():
        for point in points:
            errors = (format_number(value) for value in vars(point.error).values())
            rows.append([name, str(point.samples), format_number(point.seconds), *errors])
    return table(rows)


def goal_table(scenes: Mapping[str, Curves], ours: str) -> str:
    """Time to the goal for each scene, and how many times faster our engine is."""
    rows = [["scene", ours, *(heading for baseline in BASELINES for heading in (baseline, "×"))]]
    for scene, curves in scenes.items():
        own = time_to(curves[ours], GOAL)
        row = [scene, time_text(curves[ours], own)]
        for baseline in BASELINES:
            other = time_to(curves[baseline], GOAL)
            row += [time_text(curves[baseline], other), format_number(other / own) if math.isfinite(own) else "–"]
        rows.append(row)
    return f"Seconds to RMSE/mean {GOAL:g} (~: beyond the last picture, as the curve went on)\n\n{table(rows)}"


def budget_table(scenes: Mapping[str, Curves], ours: str, measure: str = "rmse") -> str:
    """Errors for each scene and time: of our engine, and the lowest of Cycles; bold where ours is lower."""
    rows = [["scene", *(f"{budget:g} s" for budget in BUDGETS), "last"]]
    for scene, curves in scenes.items():
        row = [scene]
        for budget in BUDGETS:
            own, best = error_at(curves[ours], budget, measure), best_baseline(curves, budget, measure)
            mark = "**" if own < best else ""
            row.append(f"{mark}{format_number(own)}{mark} ({format_number(best)})")
        rows.append([*row, format_number(getattr(curves[ours][-1].error, measure))])
    heading = f"{NAMES[measure]} of {ours} after a time (in brackets: the better of {' and '.join(BASELINES)})"
    return f"{heading}\n\n{table(rows)}"


def below_baselines(curves: Curves, ours: str) -> dict[str, bool]:
    """By time in seconds, where any engine has a picture: whether our error is below that of both baselines."""
    return {
        f"{budget:g}": error_at(curves[ours], budget) < best_baseline(curves, budget)
        for budget in BUDGETS
        if math.isfinite(min(error_at(curves[ours], budget), best_baseline(curves, budget)))
    }


def best_baseline(curves: Curves, budget: float, measure: str = "rmse") -> float:
    return min(error_at(curves[baseline], budget, measure) for baseline in BASELINES)


def time_text(points: Sequence[Point], seconds: float) -> str:
    """Seconds, with a ~ where they are extrapolated."""
    return f"~{format_number(seconds)}" if points[-1].seconds < seconds < math.inf else format_number(seconds)


def format_number(value: float) -> str:
    """A number with three significant digits."""
    if not math.isfinite(value):
        return "–"
    if value >= 100.0:
        return f"{value:.0f}"
    return f"{value:.3g}" if value >= 0.001 or value == 0.0 else f"{value:.1e}"


def table(rows: Sequence[Sequence[str]]) -> str:
    """Rows, the first of them the heading, as a Markdown table with aligned columns."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = [
        "| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) + " |" for row in rows
    ]
    return "\n".join([lines[0], "|" + "|".join("-" * (width + 2) for width in widths) + "|", *lines[1:]])
