# SPDX-License-Identifier: GPL-3.0-or-later
"""Tuned constants at half and at twice their value: `dev.py bench constants`.

The cost of an image is its squared error times CPU time. The cost of a new scene is the time to its first image. A
result is the cost relative to that of the current constant: above 1 is worse. It is the geometric mean over some scenes
of the error benchmark, in the variant that parameters are tuned on.
"""

import argparse
import math
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from statistics import geometric_mean, median

from ism_addon.gpu.gl.context import Device, open_device
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.scene import Scene, View
from ism_addon.settings import Settings
from tests.docs import record

from .error.benchmark_scene import BenchmarkScene, set_up
from .error.ism import ALL_SAMPLES, VARIANTS
from .error.metrics import rmse

PASSES = "ism_addon.gpu.passes"
SHADOW_MAPS = VARIANTS["ISM, shadow maps"]
SIZE = 320, 180  # px
TRUTH_SAMPLES = 128


def seconds(
    renderer: Renderer, scene: Scene, view: View, settings: Settings, samples: int, clock: Callable[[], float]
) -> float:
    """Time of the first `samples` samples of an image."""
    start = clock()
    for sample in range(samples):
        for _ in renderer.sample(scene, view, settings, sample, Profile()):
            pass
    renderer.submission.finish()
    return clock() - start


def error_times_time(device: Device, benchmark_scene: BenchmarkScene, settings: Settings, samples: int) -> float:
    """(RMSE/mean)² times CPU seconds, without the time for compiling and uploading."""
    renderer, view = Renderer(device), benchmark_scene.view
    warm_up_view = replace(view, clip_from_view=(1.0 + 1e-6) * view.clip_from_view)
    seconds(renderer, benchmark_scene.scene, warm_up_view, settings, samples, time.process_time)
    spent = seconds(renderer, benchmark_scene.scene, benchmark_scene.view, settings, samples, time.process_time)
    cost = rmse(renderer.picture()[..., :3], benchmark_scene.halves) ** 2 * spent
    renderer.release()
    return cost


def first_image(device: Device, benchmark_scene: BenchmarkScene) -> float:
    """Seconds of four samples of a scene without BVH and buffers: the median of three runs."""
    times = []
    for _ in range(3):
        renderer = Renderer(device)
        scene = replace(benchmark_scene.scene, meshes=tuple(replace(mesh) for mesh in benchmark_scene.scene.meshes))
        times.append(seconds(renderer, scene, benchmark_scene.view, ALL_SAMPLES, 4, time.perf_counter))
        renderer.release()
    return median(times)


@dataclass(frozen=True)
class Group:
    """Constants, by module, whose cost is measured in the same way."""

    cost: Callable[[Device, BenchmarkScene], float]
    scenes: tuple[str, ...]
    constants: dict[str, tuple[str, ...]]


GROUPS = {
    "ray-traced images, 16 samples": Group(
        lambda device, benchmark_scene: error_times_time(device, benchmark_scene, ALL_SAMPLES, 16),
        ("objects", "thin", "lamps"),
        {
            "ism_addon.gpu.culling.culling_state": (
                *("MAX_CULLED_FRACTION", "MIN_RELATIVE_IRRADIANCE", "FAINT_FRACTION", "MAX_BOUND_OVER_MEAN"),
            ),
            f"{PASSES}.light_selection.cull_lights": ("FEW_LIGHTS", "MANY_LIGHTS"),
            "ism_addon.gpu.culling.light_influence": ("STRONG_FRACTION", "UNKNOWN_VISIBILITY"),
            f"{PASSES}.light_selection.retest_occluded": ("RETEST_PROBABILITY",),
            f"{PASSES}.direct.select_faint_lights": ("MIN_LIGHT_PROBABILITY",),
            f"{PASSES}.direct.ray_correction": ("RAY_THRESHOLD", "MIN_DOUBT"),
            f"{PASSES}.direct.trace_shadows": ("MIN_RAY_PROBABILITY", "MIN_FAINT_RAY_PROBABILITY"),
            f"{PASSES}.direct.tiles_of_lights": ("CERTAIN_PROBABILITY", "MAX_CERTAIN_PROBABILITY"),
            f"{PASSES}.surfaces.select_tiles": (
                *("UNIFORM_SAMPLES", "MIN_TILE_PROBABILITY", "ALWAYS_SAMPLED_FRACTION", "MIN_MEAN_PROBABILITY"),
                "MIN_NEIGHBOUR_RATIO",
            ),
            f"{PASSES}.film.resolve": ("STRATIFICATION_EXPONENT", "SIMILARITY_SHARPNESS"),
        },
    ),
    "shadow-mapped images, 8 samples": Group(
        lambda device, benchmark_scene: error_times_time(device, benchmark_scene, SHADOW_MAPS, 8),
        ("objects", "lamps"),
        {
            f"{PASSES}.shadow_maps.light_importance": ("IMPORTANCE_POINTS",),
            f"{PASSES}.shadow_maps.sample_points": ("POINTS_PER_MAP_POINT",),
            f"{PASSES}.shadow_maps.select_points": ("SUBSETS_PER_LIGHT",),
        },
    ),
    "first images of new scenes": Group(
        first_image,
        ("atrium", "dense", "objects"),
        {
            "ism_addon.parallel": ("MIN_PARALLEL_SIZE",),
            "ism_addon.gpu.accel.blas": (
                *("TRIANGLES_PER_LEAF", "SORT_ALL_BELOW", "SAMPLED_TRIANGLES", "MAX_OVERLAP", "COHERENT_FRACTION"),
                "BOXES_PER_MESH",
            ),
            "ism_addon.gpu.buffers.small_meshes": ("SMALL_MESH",),
            "ism_addon.gpu.buffers.instance_buffers": ("MAX_OWNERS_RATIO",),
            "ism_addon.gpu.culling.frustum_slices": ("SLICES",),
        },
    ),
}
FACTORS = 0.5, 1.0, 2.0


@contextmanager
def multiplied(module: str, name: str, factor: float) -> Iterator[None]:
    """Temporarily multiply a constant of a module."""
    owner = import_module(module)
    value = getattr(owner, name)
    setattr(owner, name, type(value)(value * factor))
    try:
        yield
    finally:
        setattr(owner, name, value)


def measure(device: Device, group: Group, folder: Path) -> dict[str, dict[str, float]]:
    """By constant: its value, and the relative costs at half and twice the value."""
    costs: dict[str, dict[float, list[float]]] = {}
    values: dict[str, float] = {}
    for scene in group.scenes:
        benchmark_scene = set_up(scene, 1, SIZE, TRUTH_SAMPLES, folder)
        group.cost(device, benchmark_scene)  # compiles
        for module, names in group.constants.items():
            for name in names:
                values[name] = getattr(import_module(module), name)
                for factor in FACTORS:
                    with multiplied(module, name, factor):
                        costs.setdefault(name, {}).setdefault(factor, []).append(group.cost(device, benchmark_scene))
    rows = {}
    for name, cost in costs.items():
        half, _, double = (geometric_mean(a / b for a, b in zip(cost[f], cost[1.0], strict=True)) for f in FACTORS)
        assert math.isfinite(half) and math.isfinite(double)
        rows[name] = {"value": values[name], "half": half, "double": double}
        print(f"{name:26} {values[name]:8g}   half {half:.3f}   double {double:.3f}", flush=True)
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.constants", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the record and the truth")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    device = open_device()
    groups = {}
    for name, group in GROUPS.items():
        print(f"{name}: {', '.join(group.scenes)}", flush=True)
        groups[name] = {"scenes": group.scenes, "constants": measure(device, group, options.output)}
    print(record.write(options.output, "constants", device.name, {"size": SIZE, "groups": groups}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
