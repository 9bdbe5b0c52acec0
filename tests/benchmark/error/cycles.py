# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles on the CPU: direct light, a fixed number of samples, with or without OpenImageDenoise.

Persistent data keeps the scene and its BVH from render to render. A render that builds a BVH again is an error.
"""

import math
import re
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np

from tests.demo.figure6 import quiet_stdout
from tests.support import exr

from .benchmark_scene import SCENES, BenchmarkScene
from .engines import Render


class Cycles:
    """Counted: sampling and denoising, until the picture is done. Not counted: sync and BVH."""

    def __init__(self, benchmark_scene: BenchmarkScene, samples: tuple[int, ...], denoise: bool):
        self.name = "Cycles + OIDN" if denoise else "Cycles"
        self.benchmark_scene, self.samples, self.denoise = benchmark_scene, samples, denoise

    def start(self) -> dict[str, float]:
        """Read the scene and build the BVH."""
        prepare(SCENES[self.benchmark_scene.name].light_tree)
        first = render(1, self.denoise, seed=0)
        again = render(1, self.denoise, seed=0)
        return {"sync and BVH s": first.total - first.sampling, "memory MB": again.megabytes}

    def renders(self, round: int) -> Iterator[Render]:
        """A render for each number of samples, each started anew, as a user would."""
        for samples in self.samples:
            rendered = render(samples, self.denoise, seed=1 + round)
            if rendered.built_bvh:
                raise RuntimeError("Cycles has built a BVH again: persistent data do not hold, and the times are wrong")
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "picture.exr"
                bpy.data.images["Render Result"].save_render(str(path))
                channels = exr.read(path)  # loading it as an image would make Cycles read the scene again
                yield Render(samples, rendered.sampling, np.stack([channels[name] for name in "RGB"], axis=-1))

    def close(self) -> None:
        bpy.context.scene.render.use_persistent_data = False


def prepare(light_tree: bool) -> None:
    """Set the open file to direct light on the CPU. Other settings stay at Blender's defaults."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.use_persistent_data = True
    scene.cycles.device, scene.cycles.max_bounces = "CPU", 0
    scene.cycles.use_adaptive_sampling, scene.cycles.use_light_tree = False, light_tree
    settings = scene.render.image_settings
    settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGBA"
    settings.exr_codec = "NONE"


@dataclass(frozen=True)
class Rendered:
    """What Cycles reported of a render."""

    total: float  # s, the whole call
    sampling: float  # s, from the first sample to the end, denoising included
    megabytes: float  # peak memory, as counted by Cycles
    built_bvh: bool


def render(samples: int, denoise: bool, seed: int) -> Rendered:
    """Render the open scene, after `prepare`."""
    cycles = bpy.context.scene.cycles
    cycles.samples, cycles.use_denoising, cycles.seed = samples, denoise, seed
    status: list[tuple[float, str]] = []

    def listener(line: str, *_more: object) -> None:
        status.append((time.perf_counter(), line))

    bpy.app.handlers.render_stats.append(listener)
    start = time.perf_counter()
    try:
        with quiet_stdout():
            bpy.ops.render.render()
    finally:
        bpy.app.handlers.render_stats.remove(listener)
    total = time.perf_counter() - start
    first_sample = next(at for at, line in status if "| Sample 0/" in line)
    done = next(at for at, line in reversed(status) if line.endswith("| Finished"))
    peaks = [float(peak) for _, line in status for peak in re.findall(r"Peak:([\d.]+)M", line)]
    megabytes = max(peaks, default=math.nan)  # from Blender 5.0 on, not all renders report it
    return Rendered(total, done - first_sample, megabytes, any("Building BVH" in line for _, line in status))
