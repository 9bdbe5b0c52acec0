# SPDX-License-Identifier: GPL-3.0-or-later
"""Error as a function of time, from the medians of several rounds.

A curve is interpolated linearly in log–log between renders, and extrapolated beyond the last one from the last two.
"""

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import pairwise

from .metrics import Error

MIN_ERROR = 1e-6
MAX_LOG_EXTRAPOLATION = math.log(20.0)  # up to twenty times the last render's time


@dataclass(frozen=True)
class Point:
    """One render: its samples, its time and its errors. The record has these names."""

    samples: int
    seconds: float
    error: Error


def medians(rounds: Sequence[Sequence[Point]]) -> list[Point]:
    """Medians over all rounds, for each number of samples that every round has."""
    result = []
    for samples in sorted(set.intersection(*({point.samples for point in points} for points in rounds))):
        repeated = [point for points in rounds for point in points if point.samples == samples]
        errors = (statistics.median(getattr(each.error, member.name) for each in repeated) for member in fields(Error))
        result.append(Point(samples, statistics.median(each.seconds for each in repeated), Error(*errors)))
    return result


def time_to(points: Sequence[Point], goal: float, measure: str = "rmse") -> float:
    """Seconds until an error is down to `goal`; infinite if it never is, or only beyond the extrapolation."""
    line = logarithms(points, measure)
    target = math.log(goal)
    if line[0][1] <= target:
        return points[0].seconds
    for (time, error), (next_time, next_error) in pairwise(line):
        if next_error <= target:
            return math.exp(time + (next_time - time) * (error - target) / (error - next_error))
    slope = last_slope(line)
    beyond = (target - line[-1][1]) / slope if slope < 0.0 else math.inf
    return math.exp(line[-1][0] + beyond) if beyond < MAX_LOG_EXTRAPOLATION else math.inf


def error_at(points: Sequence[Point], seconds: float, measure: str = "rmse") -> float:
    """The error after some seconds; infinite before the first render."""
    line, now = logarithms(points, measure), math.log(seconds)
    if now < line[0][0]:
        return math.inf
    for (time, error), (next_time, next_error) in pairwise(line):
        if now <= next_time:
            return math.exp(error + (next_error - error) * (now - time) / (next_time - time))
    return math.exp(line[-1][1] + last_slope(line) * (now - line[-1][0]))


def logarithms(points: Sequence[Point], measure: str) -> list[tuple[float, float]]:
    """(log seconds, log error) of each point. An error of 0, hidden by the reference's noise, counts as MIN_ERROR."""
    return [(math.log(point.seconds), math.log(max(getattr(point.error, measure), MIN_ERROR))) for point in points]


def last_slope(line: Sequence[tuple[float, float]]) -> float:
    """The slope beyond the last point: that between the last two, but not rising, and not steeper than 1/seconds."""
    if len(line) < 2:
        return 0.0
    (time, error), (next_time, next_error) = line[-2:]
    return min(max((next_error - error) / (next_time - time), -1.0), 0.0)
