# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames/s and milliseconds per pass, without Blender: python -m tests.benchmark.gpu --output FOLDER [SNAPSHOT …]

The two cases are those of published results: the report's (Beck-Norén & Valter 2013: 105 virtual lights at 1280×720,
25 frames a second, GTX 560 Ti) and Linke's (2017: 1,024 maps of 64² at 1920×1080, at most 2,048 points in each,
8.7 ms, GTX 980). A frame is one sample without any reuse.
"""

import argparse
import itertools
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ism_addon import snapshot
from ism_addon.gpu.__main__ import resized
from ism_addon.gpu.gl.context import Device, open_device
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.scene import Scene, View
from ism_addon.settings import Method, Quality, Settings, Shadow
from tests.docs import record
from tests.scenes.small import pillar_field

WARM_UP_FRAMES = 2


@dataclass(frozen=True)
class Case:
    """The size and quality that a published result was measured at."""

    width: int
    height: int
    quality: Quality


CASES = {
    "1280×720, 105 virtual lights": Case(1280, 720, Quality(virtual_lights=105)),
    "1920×1080, 1024 virtual lights": Case(1920, 1080, Quality(virtual_lights=1024, map_size=64, map_points=2048)),
}
#: Settings by method.
METHODS = {"Ray Traced": Settings(), "Imperfect Shadow Maps": Settings(shadow=Shadow(method=Method.SHADOW_MAPS))}


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.gpu", description=__doc__.splitlines()[0])
    parser.add_argument("snapshots", nargs="*", type=Path, help="saved scenes, drawn after a field of pillars")
    parser.add_argument("--output", type=Path, required=True, help="folder of the record, gpu.json")
    parser.add_argument("--seconds", type=float, default=3.0, help="for which each case is drawn (%(default)s)")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    device = open_device()
    print(device.name)
    cases = []
    for scene_name, (scene, view) in scenes(options.snapshots).items():
        for method, case_name in itertools.product(METHODS, CASES):
            facts = {"scene": scene_name, "triangles": scene.triangle_count, "method": method, "case": case_name}
            settings = replace(METHODS[method], quality=CASES[case_name].quality)
            cases.append(facts | measure(device, scene, view, settings, CASES[case_name], options.seconds))
            print_case(cases[-1])
    record.write(options.output, "gpu", f"{device.name}, {device.gl.info['GL_VERSION']}", {"cases": cases})
    return 0


def scenes(paths: list[Path]) -> dict[str, tuple[Scene, View]]:
    """By name: scenes, and the views to draw."""
    return {"pillar field": pillar_field()} | {path.stem: snapshot.load(path)[:2] for path in paths}


def measure(device: Device, scene: Scene, view: View, settings: Settings, case: Case, seconds: float) -> dict:
    """Draw frames for some seconds. Returns frames per second, and milliseconds of a frame and of each pass."""
    renderer, profile, programs = Renderer(device), Profile(), 0
    view = resized(view, case.width, case.height)
    frames, times = 0, []
    while sum(times) < seconds:
        start = time.perf_counter()
        for _ in renderer.sample(scene, rotated(view, 0.001 * frames), settings, frames, profile):
            pass
        times.append(time.perf_counter() - start)
        frames += 1
        if frames <= WARM_UP_FRAMES or len(device.programs) > programs:  # a shader that is compiled takes seconds
            profile, times, programs = Profile(), [], len(device.programs)
    renderer.release()
    passes = {name: row.ms / len(times) for name, row in profile.rows.items() if row.drawn}
    return {
        "frames": len(times),
        "frames a second": len(times) / sum(times),
        "ms": 1e3 * float(np.median(times)),
        "passes ms": passes,
    }


def rotated(view: View, angle: float) -> View:
    """The view from a camera rotated about its vertical axis by `angle` radians."""
    rotation = np.eye(4)
    rotation[[0, 0, 2, 2], [0, 2, 0, 2]] = np.cos(angle), np.sin(angle), -np.sin(angle), np.cos(angle)
    return replace(view, view_from_world=rotation @ view.view_from_world)


def print_case(case: dict) -> None:
    print(f"\n{case['scene']} ({case['triangles']:,} triangles), {case['method']}, {case['case']}")
    print(f"{case['frames a second']:.1f} frames/s, {case['ms']:.2f} ms a frame (median of {case['frames']})")
    for name, ms in case["passes ms"].items():
        print(f"  {name:<16}{ms:9.3f} ms", flush=True)


if __name__ == "__main__":
    sys.exit(main())
