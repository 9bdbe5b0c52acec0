# SPDX-License-Identifier: GPL-3.0-or-later
"""How long the largest draw of each pass takes: `dev.py bench draws`.

The cost of a draw is estimated in shadow rays, and a draw is split above a limit, see gpu/gl/draw_limit.py. If the
estimates are right, the largest draws of all passes take about as long as those of TraceShadows. Images of the atrium
are drawn by both methods, with ambient occlusion, and with a wide pixel filter.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from statistics import median

from ism_addon.gpu.gl.context import Device, open_device
from ism_addon.gpu.gl.draw_limit import MAX_RAYS_PER_DRAW
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.scene import Scene, View
from ism_addon.settings import SSAO, Method, Quality, Settings, Shadow
from tests.docs import record

from .constants import multiplied
from .error.benchmark_scene import open_scene

WIDE_FILTER = 20.0  # px
RAYS = Settings(ssao=SSAO(), quality=Quality(samples=4, error_threshold=0.0))
MAPS = replace(RAYS, shadow=Shadow(method=Method.SHADOW_MAPS))
#: By name: settings, and the width of the pixel filter in px.
IMAGES = {"ray-traced": (RAYS, 1.5), "ray-traced, wide filter": (RAYS, WIDE_FILTER), "shadow-mapped": (MAPS, 1.5)}
#: Passes whose draws cost no more than this are not measured: most of their time is overhead.
MIN_RAYS = 100_000


class CountedRays:
    """Adds up the estimated cost of a renderer's draws, in rays."""

    def __init__(self, renderer: Renderer):
        self.rays = 0.0
        self.before_draw: Callable[[float], None] = renderer.submission.before_draw
        renderer.submission.before_draw = self.add

    def add(self, rays: float) -> None:
        self.rays += rays
        self.before_draw(rays)

    def reset(self) -> float:
        """Start again from 0. Returns the rays so far."""
        counted, self.rays = self.rays, 0.0
        return counted


def seconds_of_largest_draws(
    device: Device, scene: Scene, view: View, settings: Settings, rounds: int
) -> dict[str, list[float]]:
    """By pass, for each round: seconds of a draw at the limit, from the seconds and the cost of all draws."""
    result: dict[str, list[float]] = {}
    renderer = Renderer(device)
    counted = CountedRays(renderer)
    for index in range(-1, rounds):  # the first one compiles the shaders and is not counted
        perturbed = replace(view, clip_from_view=(1.0 + 1e-6 * index) * view.clip_from_view)
        profile, rays = Profile(), Counter()
        for sample in range(settings.quality.samples):
            for name in renderer.sample(scene, perturbed, settings, sample, profile):
                rays[name] += counted.reset()
        for name, cost in rays.items():
            if index >= 0 and cost > MIN_RAYS:
                result.setdefault(name, []).append(profile.rows[name].ms / 1e3 / cost * MAX_RAYS_PER_DRAW)
    renderer.release()
    return result


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.draws", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the record")
    parser.add_argument("--rounds", type=int, default=3, help="repetitions of each image (%(default)s)")
    parser.add_argument("--size", default="1280x720", help="WIDTHxHEIGHT in pixels (%(default)s)")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    device = open_device()
    opened = open_scene("atrium", 1, tuple(map(int, options.size.split("x"))), options.output)
    seconds = {}
    for name, (settings, width) in IMAGES.items():
        view = replace(opened.view, filter_width=width)
        with multiplied("ism_addon.gpu.submission", "SHORT_SAMPLE", 0.0):  # it waits for each pass
            seconds[name] = seconds_of_largest_draws(device, opened.scene, view, settings, options.rounds)
        print(f"{name}: seconds of the largest draw")
        for pass_name, times in seconds[name].items():
            print(f"  {pass_name:<20}{median(times):8.3f}", flush=True)
    measured = {"size": options.size, "scene": "atrium", "rays": MAX_RAYS_PER_DRAW, "seconds": seconds}
    print(record.write(options.output, "draws", device.name, measured))
    return 0


if __name__ == "__main__":
    sys.exit(main())
