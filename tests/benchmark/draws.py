# SPDX-License-Identifier: GPL-3.0-or-later
"""How long the largest draw of each pass takes: `dev.py bench draws`.

A draw says what it costs in shadow rays, and is split above a limit, see gpu/gl/draw_limit.py. If what it says is
right, the largest draws of all passes take about as long as those of TraceShadows. Images of the atrium are drawn by
both methods, with ambient occlusion, and with a wide pixel filter.
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
#: By name: settings, and the width of the pixel filter, px.
IMAGES = {"ray-traced": (RAYS, 1.5), "ray-traced, wide filter": (RAYS, WIDE_FILTER), "shadow-mapped": (MAPS, 1.5)}
#: Passes whose draws cost no more than this are not measured: most of their time is something else.
MIN_RAYS = 100_000


class CountedRays:
    """What the draws of a renderer say that they cost, in rays since it was last asked."""

    def __init__(self, renderer: Renderer):
        self.rays = 0.0
        self.before_draw: Callable[[float], None] = renderer.submission.before_draw
        renderer.submission.before_draw = self.add

    def add(self, rays: float) -> None:
        self.rays += rays
        self.before_draw(rays)

    def take(self) -> float:
        taken, self.rays = self.rays, 0.0
        return taken


def seconds_of_largest_draws(
    device: Device, scene: Scene, view: View, settings: Settings, rounds: int
) -> dict[str, list[float]]:
    """By pass, in each round: seconds over the cost of its draws, for the most that a draw may cost."""
    found: dict[str, list[float]] = {}
    renderer = Renderer(device)
    counted = CountedRays(renderer)
    for number in range(-1, rounds):  # the first compiles, and does not count
        moved = replace(view, clip_from_view=(1.0 + 1e-6 * number) * view.clip_from_view)
        profile, rays = Profile(), Counter()
        for sample in range(settings.quality.samples):
            for name in renderer.sample(scene, moved, settings, sample, profile):
                rays[name] += counted.take()
        for name, cost in rays.items():
            if number >= 0 and cost > MIN_RAYS:
                found.setdefault(name, []).append(profile.rows[name].ms / 1e3 / cost * MAX_RAYS_PER_DRAW)
    renderer.release()
    return found


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.draws", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the record")
    parser.add_argument("--rounds", type=int, default=3, help="of each image (%(default)s)")
    parser.add_argument("--size", default="1280x720", help="WIDTHxHEIGHT in pixels (%(default)s)")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    device = open_device()
    opened = open_scene("atrium", 1, tuple(map(int, options.size.split("x"))), options.output)
    seconds = {}
    for name, (settings, width) in IMAGES.items():
        view = replace(opened.view, filter_width=width)
        with multiplied("ism_addon.gpu.submission", "SHORT_SAMPLE", 0.0):  # each pass is waited for
            seconds[name] = seconds_of_largest_draws(device, opened.scene, view, settings, options.rounds)
        print(f"{name}: seconds of the largest draw")
        for pass_name, times in seconds[name].items():
            print(f"  {pass_name:<20}{median(times):8.3f}", flush=True)
    measured = {"size": options.size, "scene": "atrium", "rays": MAX_RAYS_PER_DRAW, "seconds": seconds}
    print(record.write(options.output, "draws", device.name, measured))
    return 0


if __name__ == "__main__":
    sys.exit(main())
