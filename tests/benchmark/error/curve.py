# SPDX-License-Identifier: GPL-3.0-or-later
"""Error as a function of time, from the medians of several rounds.

In log–log, a curve is straight between two pictures and goes on beyond the last one as between the last two.
"""

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import pairwise

from .metrics import Error

TINY = 1e-6
FURTHER = math.log(20.0)  # beyond twenty times the last picture's time, nobody knows


@dataclass(frozen=True)
class Point:
    """One picture's samples, and the medians over all rounds."""

    samples: int
    seconds: float
    error: Error


def medians(rounds: Sequence[Sequence[Point]]) -> list[Point]:
    """A point for each number of samples that every round has."""
    found = []
    for samples in sorted(set.intersection(*({point.samples for point in points} for points in rounds))):
        same = [point for points in rounds for point in points if point.samples == samples]
        errors = (statistics.median(getattr(each.error, part.name) for each in same) for part in fields(Error))
        found.append(Point(samples, statistics.median(each.seconds for each in same), Error(*errors)))
    return found


def time_to(points: Sequence[Point], goal: float, measure: str = "rmse") -> float:
    """Seconds until an error has fallen to `goal`, infinite if it never does."""
    line = logarithms(points, measure)
    target = math.log(goal)
    if line[0][1] <= target:
        return points[0].seconds
    for (time, error), (next_time, next_error) in pairwise(line):
        if next_error <= target:
            return math.exp(time + (next_time - time) * (error - target) / (error - next_error))
    slope = last_slope(line)
    further = (target - line[-1][1]) / slope if slope < 0.0 else math.inf
    return math.exp(line[-1][0] + further) if further < FURTHER else math.inf


def error_at(points: Sequence[Point], seconds: float, measure: str = "rmse") -> float:
    """The error after some seconds; infinite before the first picture."""
    line, now = logarithms(points, measure), math.log(seconds)
    if now < line[0][0]:
        return math.inf
    for (time, error), (next_time, next_error) in pairwise(line):
        if now <= next_time:
            return math.exp(error + (next_error - error) * (now - time) / (next_time - time))
    return math.exp(line[-1][1] + last_slope(line) * (now - line[-1][0]))


def logarithms(points: Sequence[Point], measure: str) -> list[tuple[float, float]]:
    """(log seconds, log error) of each point; an error that was lost in the truth's noise counts as TINY."""
    return [(math.log(point.seconds), math.log(max(getattr(point.error, measure), TINY))) for point in points]


def last_slope(line: Sequence[tuple[float, float]]) -> float:
    """How a curve goes on after its last point: as it fell before, neither upwards nor faster than 1/seconds."""
    if len(line) < 2:
        return 0.0
    (time, error), (next_time, next_error) = line[-2:]
    return min(max((next_error - error) / (next_time - time), -1.0), 0.0)
