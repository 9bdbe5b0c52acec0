# SPDX-License-Identifier: GPL-3.0-or-later
"""Render times of the demo's atrium: this engine with one sample, and Cycles with 1 and 16 samples.

All run alternately in one process, so that other load affects all alike. The time is that of Blender's render call:
reading the scene, building what the engine needs, and drawing; not start-up.
"""

import argparse
import statistics as middle
import sys
import time
from pathlib import Path

import bpy

from ism_addon import addon
from ism_addon.blender.engine import statistics
from ism_addon.gpu.gl.context import open_device
from ism_addon.gpu.profile import table
from tests.demo.figure6 import quiet_stdout, saved_atrium
from tests.docs import record

ENGINES = {"ISM, 1 sample": ("ISM", 1), "Cycles, 1 sample": ("CYCLES", 1), "Cycles, 16 samples": ("CYCLES", 16)}


def prepare(engine: str, samples: int, width: int, height: int) -> None:
    """Set the open scene to an engine. Cycles renders direct light only, on the CPU, without denoising."""
    scene = bpy.context.scene
    scene.render.engine = engine
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.ism.render.samples = scene.cycles.samples = samples
    scene.cycles.device, scene.cycles.max_bounces = "CPU", 0
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.atrium", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the atrium's .blend and of the record")
    parser.add_argument("--size", default="1280x720", help="WIDTHxHEIGHT in pixels (%(default)s)")
    parser.add_argument("--rounds", type=int, default=3, help="renders by each engine (%(default)s)")
    options = parser.parse_args()
    width, height = (int(number) for number in options.size.split("x"))
    options.output.mkdir(parents=True, exist_ok=True)
    addon.register()
    seconds: dict[str, list[float]] = {name: [] for name in ENGINES}
    profiles = []
    try:
        bpy.ops.wm.open_mainfile(filepath=str(saved_atrium(options.output / "atrium.blend")))
        for _ in range(options.rounds):
            for name, (engine, samples) in ENGINES.items():
                prepare(engine, samples, width, height)
                start = time.perf_counter()
                with quiet_stdout():
                    bpy.ops.render.render()
                seconds[name].append(time.perf_counter() - start)
            profiles.append(statistics())
    finally:
        addon.unregister()
    print(table(sorted(profiles, key=lambda profile: profile["seconds"])[len(profiles) // 2]))
    for name, times in seconds.items():
        print(f"{name:<20} {middle.median(times):6.2f} s  ({min(times):.2f} to {max(times):.2f})")
    measured = {"size": options.size, "seconds": seconds, "profiles": profiles}
    record.write(options.output, "atrium", open_device().name, measured)
    return 0


if __name__ == "__main__":
    sys.exit(main())
