# SPDX-License-Identifier: GPL-3.0-or-later
"""Time saved by skipping work that does not change a picture, and by reusing results: `dev.py bench skip`.

Every case of tests/scenes/shortcuts.py is drawn with and without shortcuts (`--no-shortcuts`). Reported are the ratio
of the times, the difference of the pictures, and counts. For the atrium, the times to the same errors, against Cycles'
reference, are reported too, and how much shorter they would be if all visibility were known, see known.py.
"""

import argparse
import sys
import time
from dataclasses import asdict, replace
from pathlib import Path
from statistics import median

import numpy as np

from ism_addon.gpu.gl.context import Device, open_device
from ism_addon.gpu.profile import COUNTS, Profile
from ism_addon.gpu.renderer import Renderer
from tests.docs import record
from tests.scenes.shortcuts import Case, Picture, cases

from .error.benchmark_scene import set_up
from .error.curve import time_to
from .error.ism import ALL_SAMPLES, Ism
from .error.measure import measure
from .known import Known

COLUMNS = ("ms", "no skip", "faster", "apart", "drawn", "reused", "skipped")
#: Of each of the two references.
TRUTH_SAMPLES = 128
#: The errors after these numbers of samples are the goals.
GOALS = 1, 4, 16, 64
SECONDS = 16.0  # for which each variant accumulates
COUNTS_SHOWN = ("lights_used", "triangles_drawn", "pixels_drawn", "pairs_traced", "retests", "bytes_uploaded")


def draw(renderer: Renderer, picture: Picture) -> tuple[float, Profile, np.ndarray]:
    """Draw all samples. Returns their seconds, their profile and the picture."""
    scene, view, settings = picture
    profile, start = Profile(), time.perf_counter()
    for sample in range(settings.quality.samples):
        for _ in renderer.sample(scene, view, settings, sample, profile):
            pass
    color = renderer.picture()[..., :3]
    return time.perf_counter() - start, profile, color


def draw_case(device: Device, case: Case, shortcuts: bool) -> tuple[float, Profile, np.ndarray]:
    """Draw a case with a new renderer, after the picture that precedes it, if any."""
    renderer = Renderer(device)
    for picture in filter(None, (case.before, case.picture)):
        drawn = draw(renderer, (*picture[:2], replace(picture[2], shortcuts=shortcuts)))
    renderer.release()
    return drawn


def measure_case(device: Device, case: Case, rounds: int) -> dict:
    """The median times of a case with and without shortcuts, the pictures' difference and the counts."""
    times: dict[bool, list[float]] = {True: [], False: []}
    pictures, profiles = {}, {}
    for _ in range(rounds):
        for shortcuts, seconds in times.items():
            taken, profiles[shortcuts], pictures[shortcuts] = draw_case(device, case, shortcuts)
            seconds.append(taken)
    ms = {shortcuts: 1e3 * median(seconds) for shortcuts, seconds in times.items()}
    difference = np.sqrt(((pictures[True] - pictures[False]) ** 2).mean()) / max(pictures[False].mean(), 1e-6)
    passes = {name: asdict(each) for name, each in profiles[True].rows.items()}
    return {
        "ms": ms[True],
        "no skip": ms[False],
        "faster": ms[False] / ms[True],
        "apart": float(difference),
        **{name: sum(each[name] for each in passes.values()) for name in COLUMNS[4:]},
        **{name: profiles[True].counts[name] for name in COUNTS},
        "passes": passes,
    }


def table_row(name: str, case: dict) -> str:
    """A row of the table, in Markdown."""
    times = f"{case['ms']:.0f} | {case['no skip']:.0f} | {case['faster']:.1f}× | {case['apart']:.4f}"
    counts = " | ".join(f"{case[count]:,}" for count in (*COLUMNS[4:], *COUNTS_SHOWN))
    return f"| {name} | {times} | {counts} |"


def times_to_goals(device: Device, folder: Path, rounds: int) -> list[dict]:
    """Seconds to each goal in the atrium: with shortcuts, without, and with known visibility."""
    benchmark_scene = set_up("atrium", 0, (640, 360), TRUTH_SAMPLES, folder)
    variants = {"skip": ALL_SAMPLES, "no skip": replace(ALL_SAMPLES, shortcuts=False)}
    engines = [Ism(name, settings, device, benchmark_scene, SECONDS) for name, settings in variants.items()]
    known = Known("all known", ALL_SAMPLES, device, benchmark_scene, SECONDS)
    curves = measure(benchmark_scene, [*engines, known], rounds).curves
    goals = []
    for point in (point for point in curves["skip"] if point.samples in GOALS):
        seconds = {name: time_to(points, point.error.rmse) for name, points in curves.items()}
        faster = {f"{name} faster": seconds["no skip"] / seconds[name] for name in ("skip", "all known")}
        goals.append({"samples": point.samples, "rmse": point.error.rmse, **seconds, **faster})
    return goals


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.skip", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the record, skip.json and skip.md")
    parser.add_argument(
        "--rounds", type=int, default=1, help="repetitions of each case; medians are taken (%(default)s)"
    )
    parser.add_argument("--size", default="320x180", help="WIDTHxHEIGHT in pixels (%(default)s)")
    parser.add_argument("--only", default="", help="cases whose names contain this")
    parser.add_argument(
        "--quick", action="store_true", help="the cases alone, without the atrium's times to the same error"
    )
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    device, atrium = open_device(), []
    chosen = [case for case in cases(*map(int, options.size.split("x"))) if options.only in case.name]
    if not chosen:
        parser.error(f"no case's name contains {options.only}")
    draw_case(device, chosen[0], True)  # compiles the shaders
    headings = ("case", *COLUMNS, *(name.replace("_", " ") for name in COUNTS_SHOWN))
    lines = ["| " + " | ".join(headings) + " |", "|---" * len(headings) + "|"]
    print("\n".join(lines), flush=True)
    results: dict[str, dict] = {}
    for case in chosen:
        results[case.name] = measure_case(device, case, options.rounds)
        lines.append(table_row(case.name, results[case.name]))
        print(lines[-1], flush=True)
    if not (options.only or options.quick):
        atrium = times_to_goals(device, options.output, options.rounds)
        lines += ["", "| atrium, RMSE/mean | seconds | no skip | faster | if all were known |", "|---|---|---|---|---|"]
        for goal in atrium:
            faster = f"{goal['skip faster']:.2f}× | {goal['all known faster']:.2f}×"
            lines.append(f"| {goal['rmse']:.4f} | {goal['skip']:.2f} | {goal['no skip']:.2f} | {faster} |")
        print("\n".join(lines[-len(GOALS) - 3 :]))
    record.write(options.output, "skip", device.name, {"cases": results, "atrium": atrium})
    (options.output / "skip.md").write_text("\n".join(lines) + "\n", "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
