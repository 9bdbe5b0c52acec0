# SPDX-License-Identifier: GPL-3.0-or-later
"""The measurements as tables in Markdown: every point of a scene, and the summary that the bounds are about."""

import math
from collections.abc import Mapping, Sequence

from .curve import Point, error_at, time_to
from .measure import Result
from .metrics import EPSILON

Curves = Mapping[str, Sequence[Point]]  # by the engine's name

GOAL = 0.05  # RMSE over mean that engines race to
BUDGETS = (0.3, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0, 20.0)  # s
RIVALS = ("Cycles", "Cycles + OIDN")
NAMES = {"rmse": "RMSE/mean", "relmse": "relMSE"}
COUNTED = (
    "Counted is what a further picture of an open scene costs: all passes of all samples, or Cycles' sampling and "
    "denoising from its first sample on. Not counted: start-up, reading the scene, BVH, shaders (see each scene). "
    f"RMSE and relMSE (ε = {EPSILON:g} of the squared mean) are free of the truth's noise, which is in the two halves "
    "of the reference; the 99th percentile of |error|/mean and FLIP are not. Medians of the rounds."
)


def summary(results: Mapping[str, Result], ours: Sequence[str]) -> str:
    """Who is sooner where, for each form of ours, and what is counted."""
    scenes = {name: result.curves for name, result in results.items()}
    tables = [
        part for name in ours for part in (race_table(scenes, name), *(budget_table(scenes, name, m) for m in NAMES))
    ]
    missing = {f"{engine} did not run: {why}." for result in results.values() for engine, why in result.missing.items()}
    return "\n\n".join([*tables, COUNTED, *sorted(missing)])


def scene(name: str, result: Result) -> str:
    """One scene's facts and points."""
    facts = ", ".join(f"{fact} {number(value)}" for fact, value in result.facts.items())
    starts = [
        f"- {engine}: " + ", ".join(f"{what} {number(value)}" for what, value in start.items())
        for engine, start in result.starts.items()
    ]
    return "\n\n".join([f"## {name}", facts, scene_table(result.curves), "Not counted:\n" + "\n".join(starts)])


def scene_table(curves: Curves) -> str:
    """A row for each engine and number of samples."""
    rows = [["engine", "samples", "s", "RMSE/mean", "relMSE", "99 %", "FLIP"]]
    for name, points in curves.items():
        for point in points:
            errors = (number(value) for value in vars(point.error).values())
            rows.append([name, str(point.samples), number(point.seconds), *errors])
    return table(rows)


def race_table(scenes: Mapping[str, Curves], ours: str) -> str:
    """Time to the goal for each scene, and how many times sooner ours is there."""
    rows = [["scene", ours, *(part for rival in RIVALS for part in (rival, "×"))]]
    for scene, curves in scenes.items():
        mine = time_to(curves[ours], GOAL)
        row = [scene, told_time(curves[ours], mine)]
        for rival in RIVALS:
            theirs = time_to(curves[rival], GOAL)
            row += [told_time(curves[rival], theirs), number(theirs / mine) if math.isfinite(mine) else "–"]
        rows.append(row)
    return f"Seconds to RMSE/mean {GOAL:g} (~: beyond the last picture, as the curve went on)\n\n{table(rows)}"


def budget_table(scenes: Mapping[str, Curves], ours: str, measure: str = "rmse") -> str:
    """For each scene and budget: ours, and the better of the rivals; bold where ours is below both."""
    rows = [["scene", *(f"{budget:g} s" for budget in BUDGETS), "last"]]
    for scene, curves in scenes.items():
        row = [scene]
        for budget in BUDGETS:
            mine, best = error_at(curves[ours], budget, measure), best_rival(curves, budget, measure)
            mark = "**" if mine < best else ""
            row.append(f"{mark}{number(mine)}{mark} ({number(best)})")
        rows.append([*row, number(getattr(curves[ours][-1].error, measure))])
    heading = f"{NAMES[measure]} of {ours} after a time (in brackets: the better of {' and '.join(RIVALS)})"
    return f"{heading}\n\n{table(rows)}"


def wins(curves: Curves, ours: str) -> dict[str, bool]:
    """Budget in seconds: whether ours is below both rivals, where anyone has a picture."""
    return {
        f"{budget:g}": error_at(curves[ours], budget) < best_rival(curves, budget)
        for budget in BUDGETS
        if math.isfinite(min(error_at(curves[ours], budget), best_rival(curves, budget)))
    }


def best_rival(curves: Curves, budget: float, measure: str = "rmse") -> float:
    return min(error_at(curves[rival], budget, measure) for rival in RIVALS)


def told_time(points: Sequence[Point], seconds: float) -> str:
    """Seconds, marked where no picture was as late."""
    return f"~{number(seconds)}" if points[-1].seconds < seconds < math.inf else number(seconds)


def number(value: float) -> str:
    """Three digits that count."""
    if not math.isfinite(value):
        return "–"
    if value >= 100.0:
        return f"{value:.0f}"
    return f"{value:.3g}" if value >= 0.001 or value == 0.0 else f"{value:.1e}"


def table(rows: Sequence[Sequence[str]]) -> str:
    """Rows, the first of them the heading, as Markdown that is straight in a terminal too."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = [
        "| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) + " |" for row in rows
    ]
    return "\n".join([lines[0], "|" + "|".join("-" * (width + 2) for width in widths) + "|", *lines[1:]])
