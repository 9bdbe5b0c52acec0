# SPDX-License-Identifier: GPL-3.0-or-later
"""What is saved by leaving out what does not change a picture, and by keeping what did not change: `dev.py bench skip`.

Every case of tests/scenes/shortcuts.py is drawn twice, as always and with nothing left out (`--no-shortcuts`): the
ratio of the times, how far the pictures are apart, and the counts. Then the atrium, by the times that both take to the
same error, against Cycles' picture; and beside it how much sooner it would be there if nothing had to be found, see
known.
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
#: Of the truth's halves.
TRUTH_SAMPLES = 128
#: Samples whose error is the goal.
GOALS = 1, 4, 16, 64
SECONDS = 16.0  # that each accumulates
COUNTED = ("lights_used", "triangles_drawn", "pixels_drawn", "pairs_traced", "retests", "bytes_uploaded")


def draw(renderer: Renderer, picture: Picture) -> tuple[float, Profile, np.ndarray]:
    """Seconds that all samples took, their profile and the picture."""
    scene, view, settings = picture
    profile, start = Profile(), time.perf_counter()
    for sample in range(settings.quality.samples):
        for _ in renderer.sample(scene, view, settings, sample, profile):
            pass
    color = renderer.picture()[..., :3]
    return time.perf_counter() - start, profile, color


def measured(device: Device, case: Case, skip: bool) -> tuple[float, Profile, np.ndarray]:
    """A case by a new renderer, after the picture before it."""
    renderer = Renderer(device)
    for picture in filter(None, (case.before, case.picture)):
        found = draw(renderer, (*picture[:2], replace(picture[2], shortcuts=skip)))
    renderer.release()
    return found


def row(device: Device, case: Case, rounds: int) -> dict:
    """Medians of a case's rounds, and its counts."""
    times: dict[bool, list[float]] = {True: [], False: []}
    pictures, profiles = {}, {}
    for _ in range(rounds):
        for skip, seconds in times.items():
            taken, profiles[skip], pictures[skip] = measured(device, case, skip)
            seconds.append(taken)
    ms = {skip: 1e3 * median(seconds) for skip, seconds in times.items()}
    apart = np.sqrt(((pictures[True] - pictures[False]) ** 2).mean()) / max(pictures[False].mean(), 1e-6)
    passes = {name: asdict(each) for name, each in profiles[True].rows.items()}
    return {
        "ms": ms[True],
        "no skip": ms[False],
        "faster": ms[False] / ms[True],
        "apart": float(apart),
        **{what: sum(each[what] for each in passes.values()) for what in COLUMNS[4:]},
        **{name: profiles[True].counts[name] for name in COUNTS},
        "passes": passes,
    }


def line(name: str, found: dict) -> str:
    """A row of the table, in Markdown."""
    times = f"{found['ms']:.0f} | {found['no skip']:.0f} | {found['faster']:.1f}× | {found['apart']:.4f}"
    counts = " | ".join(f"{found[count]:,}" for count in (*COLUMNS[4:], *COUNTED))
    return f"| {name} | {times} | {counts} |"


def to_the_same_error(device: Device, folder: Path, rounds: int) -> list[dict]:
    """Of the atrium: seconds to the error that some numbers of samples have, with skipping, without, and told all."""
    stage = set_up("atrium", 0, (640, 360), TRUTH_SAMPLES, folder)
    variants = {"skip": ALL_SAMPLES, "no skip": replace(ALL_SAMPLES, shortcuts=False)}
    engines = [Ism(name, settings, device, stage, SECONDS) for name, settings in variants.items()]
    known = Known("all known", ALL_SAMPLES, device, stage, SECONDS)
    curves = measure(stage, [*engines, known], rounds).curves
    found = []
    for point in (point for point in curves["skip"] if point.samples in GOALS):
        seconds = {name: time_to(points, point.error.rmse) for name, points in curves.items()}
        faster = {f"{name} faster": seconds["no skip"] / seconds[name] for name in ("skip", "all known")}
        found.append({"samples": point.samples, "rmse": point.error.rmse, **seconds, **faster})
    return found


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.skip", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the record, skip.json and skip.md")
    parser.add_argument("--rounds", type=int, default=1, help="of each case; medians are taken (%(default)s)")
    parser.add_argument("--size", default="320x180", help="WIDTHxHEIGHT in pixels (%(default)s)")
    parser.add_argument("--only", default="", help="cases whose names hold this")
    parser.add_argument("--quick", action="store_true", help="the cases alone, without the atrium's race")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    device, atrium = open_device(), []
    chosen = [case for case in cases(*map(int, options.size.split("x"))) if options.only in case.name]
    if not chosen:
        parser.error(f"no case's name holds {options.only}")
    measured(device, chosen[0], True)  # shaders are compiled by then
    heads = ("case", *COLUMNS, *(name.replace("_", " ") for name in COUNTED))
    lines = ["| " + " | ".join(heads) + " |", "|---" * len(heads) + "|"]
    print("\n".join(lines), flush=True)
    found: dict[str, dict] = {}
    for case in chosen:
        found[case.name] = row(device, case, options.rounds)
        lines.append(line(case.name, found[case.name]))
        print(lines[-1], flush=True)
    if not (options.only or options.quick):
        atrium = to_the_same_error(device, options.output, options.rounds)
        lines += ["", "| atrium, RMSE/mean | seconds | no skip | faster | if all were known |", "|---|---|---|---|---|"]
        for goal in atrium:
            faster = f"{goal['skip faster']:.2f}× | {goal['all known faster']:.2f}×"
            lines.append(f"| {goal['rmse']:.4f} | {goal['skip']:.2f} | {goal['no skip']:.2f} | {faster} |")
        print("\n".join(lines[-len(GOALS) - 3 :]))
    record.write(options.output, "skip", device.name, {"cases": found, "atrium": atrium})
    (options.output / "skip.md").write_text("\n".join(lines) + "\n", "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
