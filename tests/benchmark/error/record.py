# SPDX-License-Identifier: GPL-3.0-or-later
"""Results of the race as plain values for the record, and back."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict

from .curve import Point, time_to
from .measure import Result
from .metrics import Error
from .report import GOAL, wins


def told(result: Result, ours: Sequence[str]) -> dict[str, object]:
    """One scene."""
    curves = result.curves
    races = {name: time_to(points, GOAL) for name, points in curves.items()}
    return {
        "facts": result.facts,
        "not counted": result.starts,
        "missing": result.missing,
        f"seconds to {GOAL:g}": {name: t if math.isfinite(t) else None for name, t in races.items()},
        "below both Cycles": {name: wins(curves, name) for name in ours},
        "rounds": {
            name: [[asdict(point) for point in points] for points in rounds] for name, rounds in result.rounds.items()
        },
    }


def result_of(told: Mapping) -> Result:
    """The scene that `told` was made of."""
    rounds = {
        name: [[Point(each["samples"], each["seconds"], Error(**each["error"])) for each in points] for points in turns]
        for name, turns in told["rounds"].items()
    }
    return Result(told["facts"], told["not counted"], told["missing"], rounds)
