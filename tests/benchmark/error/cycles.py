# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles on the processor: direct light, fixed samples, with or without OpenImageDenoise as Blender sets it.

Persistent data keeps the scene and its BVH from render to render; that none is built again is watched.
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
    """Counted: from the moment that sampling starts until the picture is done. Not counted: sync and BVH."""

    def __init__(self, stage: BenchmarkScene, samples: tuple[int, ...], denoise: bool):
        self.name = "Cycles + OIDN" if denoise else "Cycles"
        self.stage, self.samples, self.denoise = stage, samples, denoise

    def start(self) -> dict[str, float]:
        """Read the scene and build the BVH."""
        prepare(SCENES[self.stage.name].light_tree)
        first = render(1, self.denoise, seed=0)
        again = render(1, self.denoise, seed=0)
        return {"sync and BVH s": first.whole - first.sampling, "memory MB": again.megabytes}

    def shots(self, round: int) -> Iterator[Render]:
        """A picture of each number of samples, each from the beginning, as users do."""
        for samples in self.samples:
            done = render(samples, self.denoise, seed=1 + round)
            if done.built:
                raise RuntimeError("Cycles has built a BVH again: persistent data do not hold, and the times are wrong")
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "picture.exr"
                bpy.data.images["Render Result"].save_render(str(path))
                channels = exr.read(path)  # to load it as an image would make Cycles read the scene again
                yield Render(samples, done.sampling, np.stack([channels[name] for name in "RGB"], axis=-1))

    def close(self) -> None:
        bpy.context.scene.render.use_persistent_data = False


def prepare(light_tree: bool) -> None:
    """Set the open file to direct light on the processor; everything else stays as Blender has it."""
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
    """What Cycles said of a render."""

    whole: float  # s, the call
    sampling: float  # s, from the first sample on, denoising included
    megabytes: float  # at the peak, as far as Cycles counts them
    built: bool  # whether there was a BVH to build


def render(samples: int, denoise: bool, seed: int) -> Rendered:
    """Render the open scene as `prepare` has set it."""
    cycles = bpy.context.scene.cycles
    cycles.samples, cycles.use_denoising, cycles.seed = samples, denoise, seed
    told: list[tuple[float, str]] = []
    listener = lambda line, *_: told.append((time.perf_counter(), line))  # noqa: E731 - handlers are told apart
    bpy.app.handlers.render_stats.append(listener)
    start = time.perf_counter()
    try:
        with quiet_stdout():
            bpy.ops.render.render()
    finally:
        bpy.app.handlers.render_stats.remove(listener)
    whole = time.perf_counter() - start
    sampling = next(at for at, line in told if "| Sample 0/" in line)
    done = next(at for at, line in reversed(told) if line.endswith("| Finished"))
    peaks = [float(peak) for _, line in told for peak in re.findall(r"Peak:([\d.]+)M", line)]
    megabytes = max(peaks, default=math.nan)  # from Blender 5.0 on not all renders say it
    return Rendered(whole, done - sampling, megabytes, any("Building BVH" in line for _, line in told))
