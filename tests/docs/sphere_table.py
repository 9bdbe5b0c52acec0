# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of shaders on spheres in docs/benchmarks.md: their largest errors under each light."""

from collections.abc import Iterator, Mapping
from statistics import median

from tests.benchmark.error.report import table

from . import record

#: By light, shader and roughness: "error" and "noise" of blocks' means, "rmse", and each reference's samples, "truth".
Cases = Mapping[str, Mapping[str, Mapping[str, Mapping[str, float]]]]

#: The largest error that is not listed, and what is aimed at.
BOUND, AIM = 0.01, 0.003
#: An error that is less than this multiple of the reference's noise is not known to be one.
NOISY = 3.0


def rows(cases: Cases) -> str:
    """A row for each shader: the median over its roughnesses and the largest error, in %."""
    lines = [["%, median (largest)", *cases]]
    for shader in next(iter(cases.values())):
        errors = [[100.0 * each["error"] for each in shaders[shader].values()] for shaders in cases.values()]
        lines.append([shader, *(f"{median(each):.2f} ({max(each):.2f})" for each in errors)])
    return table(lines)


def large_errors(cases: Cases) -> Iterator[tuple[str, str, str, Mapping[str, float]]]:
    """Light, shader, roughness and errors of cases outside of the bound."""
    for light, shaders in cases.items():
        for shader, by_roughness in shaders.items():
            for roughness, errors in by_roughness.items():
                if errors["error"] > BOUND:
                    yield light, shader, roughness, errors


def is_doubtful(errors: Mapping[str, float], bound: float = BOUND) -> bool:
    """Whether an error is outside of the bound, or not a number, and the reference's noise may be why."""
    return not (errors["error"] <= bound or NOISY * errors["noise"] <= bound)


def outside(cases: Cases) -> str:
    """A row for each case outside of the bound."""
    lines = [["shader", "roughness", "light", "error, %", "noise of Cycles, %", "its samples", "RMSE / mean"]]
    for light, shader, roughness, errors in large_errors(cases):
        numbers = f"{100.0 * errors['error']:.2f}", f"{100.0 * errors['noise']:.2f}", f"{errors['rmse']:.3f}"
        limited = " (limits)" if errors["error"] < NOISY * errors["noise"] else ""
        noise = f"{numbers[1]}{limited}"
        lines.append([shader, roughness, light, numbers[0], noise, f"{2 * errors['truth']:,}", numbers[2]])
    return table(lines)


def sphere_table() -> str:
    """The tables, and their origin."""
    recorded = record.read("spheres")
    cases = recorded["cases"]
    every = [each["error"] for shaders in cases.values() for by in shaders.values() for each in by.values()]
    counts = ", ".join(f"{sum(each <= bound for each in every)} within {100.0 * bound:g} %" for bound in (AIM, BOUND))
    beyond = f"Outside of {100.0 * BOUND:g} %, and whether Cycles' noise limits what can be said:\n\n{outside(cases)}"
    return f"{rows(cases)}\n\nOf {len(every)} cases {counts}. {record.sentence(recorded)}\n\n{beyond}"
