# SPDX-License-Identifier: GPL-3.0-or-later
"""Error against time of every engine on sixteen scenes: `dev.py bench error`.

It writes error.md and error.json, and asserts nothing.
"""

import argparse
import sys
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from ism_addon.gpu.gl.context import Device, open_device
from tests.docs import record

from . import report
from .benchmark_scene import SCENES, BenchmarkScene, set_up
from .cycles import Cycles
from .eevee import Eevee
from .engines import Engine
from .ism import VARIANTS, Ism
from .measure import Result, measure
from .record import result_to_json


@dataclass(frozen=True)
class Effort:
    """How much is measured. The record has these names."""

    scenes: tuple[str, ...]
    size: tuple[int, int]  # px
    truth: int  # samples of each of the two reference images
    cycles: tuple[int, ...]  # samples of its renders
    eevee: tuple[int, ...]  # samples of its renders
    seconds: float  # for which our engine accumulates
    rounds: int


FULL = Effort(tuple(SCENES), (640, 360), 256, (1, 2, 4, 8, 16, 64), (1, 4, 16), 22.0, 3)
QUICK = Effort(("objects", "thin"), (320, 180), 64, (1, 4, 16), (1, 4), 4.0, 1)


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.error", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the record, the tables and the truth")
    parser.add_argument("--quick", action="store_true", help="small pictures of two scenes, one round: rough numbers")
    parser.add_argument("--scenes", help=f"some of {','.join(SCENES)}")
    parser.add_argument("--rounds", type=int, help=f"repetitions; medians are taken ({FULL.rounds})")
    parser.add_argument("--seconds", type=float, help=f"for which our engine accumulates ({FULL.seconds:g})")
    parser.add_argument("--tuning", action="store_true", help="the variants of the scenes that parameters are tuned on")
    parser.add_argument("--blender", default="blender", help="the program that renders with EEVEE (%(default)s)")
    options = parser.parse_args()
    effort = QUICK if options.quick else FULL
    scenes = tuple(options.scenes.split(",")) if options.scenes else effort.scenes
    effort = replace(
        effort,
        scenes=scenes,
        rounds=options.rounds or effort.rounds,
        seconds=options.seconds or effort.seconds,
    )
    if unknown := [name for name in scenes if name not in SCENES]:
        parser.error(f"no such scene: {', '.join(unknown)}")
    options.output.mkdir(parents=True, exist_ok=True)
    device = open_device()
    results = {}
    for name in scenes:
        benchmark_scene = set_up(name, int(options.tuning), effort.size, effort.truth, options.output)
        all_engines = engines(benchmark_scene, effort, device, options.blender)
        results[name] = measure(benchmark_scene, all_engines, effort.rounds)
        print(report.scene(name, results[name]), flush=True)
    write(results, effort, device, options)
    return 0


def engines(benchmark_scene: BenchmarkScene, effort: Effort, device: Device, blender: str) -> list[Engine]:
    """All engines, in the order of the first round."""
    ours = [Ism(name, settings, device, benchmark_scene, effort.seconds) for name, settings in VARIANTS.items()]
    cycles = [Cycles(benchmark_scene, effort.cycles, denoise) for denoise in (False, True)]
    return [*ours, *cycles, Eevee(benchmark_scene, effort.eevee, blender)]


def write(results: dict[str, Result], effort: Effort, device: Device, options: argparse.Namespace) -> None:
    """Print the summary, and write the tables and the record."""
    summary = report.summary(results, list(VARIANTS))
    print(summary)
    tables = "\n\n".join(report.scene(name, result) for name, result in results.items())
    (options.output / "error.md").write_text(f"{summary}\n\n{tables}\n", "utf-8")
    scenes = {name: result_to_json(result, list(VARIANTS)) for name, result in results.items()}
    measured = {"tuning": options.tuning, "effort": asdict(effort), "scenes": scenes}
    print(record.write(options.output, "error", device.name, measured))


if __name__ == "__main__":
    sys.exit(main())
