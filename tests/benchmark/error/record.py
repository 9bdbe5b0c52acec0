# SPDX-License-Identifier: GPL-3.0-or-later
"""Results of the error benchmark to and from the JSON of its record."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict

from .curve import Point, time_to
from .measure import Result
from .metrics import Error
from .report import GOAL, below_baselines


def result_to_json(result: Result, ours: Sequence[str]) -> dict[str, object]:
    """One scene's result, as values that JSON has."""
    curves = result.curves
    times = {name: time_to(points, GOAL) for name, points in curves.items()}
    return {
        "facts": result.facts,
        "not counted": result.uncounted,
        "missing": result.missing,
        f"seconds to {GOAL:g}": {name: t if math.isfinite(t) else None for name, t in times.items()},
        "below both Cycles": {name: below_baselines(curves, name) for name in ours},
        "rounds": {
            name: [[asdict(point) for point in points] for points in rounds] for name, rounds in result.rounds.items()
        },
    }


def result_from_json(scene: Mapping) -> Result:
    """The result that `result_to_json` was given."""
    rounds = {
        name: [
            [Point(point["samples"], point["seconds"], Error(**point["error"])) for point in points] for points in runs
        ]
        for name, runs in scene["rounds"].items()
    }
    return Result(scene["facts"], scene["not counted"], scene["missing"], rounds)
