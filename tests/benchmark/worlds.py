# SPDX-License-Identifier: GPL-3.0-or-later
"""Error of the light of worlds on surfaces that nothing shadows, beside Cycles: `dev.py bench worlds`.

Errors are those of means of blocks of 8×8 pixels. Worlds whose error the noise of Cycles' picture limits are measured
again beside references of more samples.
"""

import argparse
import sys
from pathlib import Path

import bpy
import numpy as np

from ism_addon import addon
from ism_addon.gpu.gl.context import open_device
from ism_addon.gpu.jobs.png import display_from_linear, write_png
from tests.demo.figure6 import quiet_stdout
from tests.docs import record
from tests.docs.sphere_table import is_doubtful
from tests.docs.world_table import BOUND, rows
from tests.scenes.cycles import direct_light
from tests.scenes.materials.spheres import squares
from tests.scenes.worlds import open_sky

from .error.benchmark_scene import SEEDS
from .files import FILTER_WIDTH, our_render
from .spheres import MORE_SAMPLES, compare

#: Pixels along the sides of a surface's square.
SIDE = 96


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.worlds", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the record and the pictures")
    parser.add_argument("--worlds", nargs="+", help="only these")
    parser.add_argument("--samples", type=int, default=1024, help="of our pictures (%(default)s)")
    parser.add_argument("--truth", type=int, default=256, help="samples of each of two references (%(default)s)")
    parser.add_argument("--finest", type=int, default=30000, help="samples where their noise matters (%(default)s)")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    addon.register()
    opengl, measured = open_device().name, dict[str, dict[str, dict[str, float]]]()
    try:
        for name in options.worlds or open_sky.worlds():
            measured[name] = measure(name, options)
            written = record.write(options.output, "worlds", opengl, {"samples": options.samples, "worlds": measured})
    finally:
        addon.unregister()
    print(rows(measured))
    print(written)
    return 0


def measure(name: str, options: argparse.Namespace) -> dict[str, dict[str, float]]:
    """Errors under a world, by surface."""
    with quiet_stdout():
        open_sky.build(SIDE)
        bpy.context.scene.world = open_sky.worlds()[name]()
        bpy.context.scene.render.filter_size = FILTER_WIDTH
        ours, _ = our_render(options.samples)
        truth = options.truth
        while True:
            halves = [direct_light(truth, FILTER_WIDTH, seed=seed)[..., :3] for seed in SEEDS]
            pictures = (squares(each, SIDE) for each in (ours, *halves))
            errors = {
                surface: {**compare(*each), "truth": truth}
                for surface, *each in zip(open_sky.SURFACES, *pictures, strict=True)
            }
            if truth * MORE_SAMPLES > options.finest or not any(is_doubtful(each, BOUND) for each in errors.values()):
                break
            truth *= MORE_SAMPLES
    write_beside(options.output / f"worlds-{name.replace(' ', '-')}.png", ours, np.mean(halves, 0))
    print(f"{name:36}", *(f"{surface} {each['error']:.5f} ({each['noise']:.5f})" for surface, each in errors.items()))
    return errors


def write_beside(path: Path, ours: np.ndarray, theirs: np.ndarray) -> None:
    """Write our picture above Cycles' and ten times their difference."""
    level = 0.3 / theirs.mean()
    beside = np.concatenate([level * ours, level * theirs, np.clip(0.2 + 10.0 * level * (ours - theirs), 0.0, 1.0)])
    write_png(path, display_from_linear(np.concatenate([beside, np.ones_like(beside[..., :1])], axis=2)))


if __name__ == "__main__":
    sys.exit(main())
