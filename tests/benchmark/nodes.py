# SPDX-License-Identifier: GPL-3.0-or-later
"""Error of each shader node with each of its options, beside Cycles' picture of it: `dev.py bench nodes`.

Squares of 32×32 pixels, 64 in a picture, each with a material that shows one case of tests/scenes/nodes.
A sun lights them such that the radiance of level ones is their colour.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import bpy
import numpy as np

from ism_addon import addon
from ism_addon.gpu.gl.context import open_device
from ism_addon.gpu.jobs.png import display_from_linear, write_png
from tests.demo.figure6 import quiet_stdout
from tests.docs import record
from tests.docs.node_table import rows
from tests.scenes.cycles import direct_light
from tests.scenes.nodes.case import NodeCase, add_object, build
from tests.scenes.nodes.cases import cases
from tests.tools.new_file import open_empty_file

from .files import FILTER_WIDTH, our_render

#: Pixels along the sides of a square, squares along the sides of a picture, and pixels at a square's border left out.
SIDE, COLUMNS, BORDER = 32, 8, 3


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.nodes", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the record and the pictures")
    parser.add_argument("--only", default="", help="cases whose name contains this")
    parser.add_argument("--samples", type=int, default=64, help="of both engines (%(default)s)")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    chosen = [case for case in cases() if options.only in case.name]
    addon.register()
    try:
        errors = measure(chosen, options.samples, options.output)
    finally:
        addon.unregister()
    print(rows(errors))
    print(record.write(options.output, "nodes", open_device().name, {"samples": options.samples, "rmse": errors}))
    return 0


def measure(chosen: Sequence[NodeCase], samples: int, output: Path | None = None) -> dict[str, float]:
    """RMSE of each case that this Blender has, by its name. Pictures of both engines are written to `output`."""
    errors: dict[str, float] = {}
    count = COLUMNS**2
    for first in range(0, len(chosen), count):
        sheet = chosen[first : first + count]
        with quiet_stdout():
            built = arrange(sheet)
            ours, _ = our_render(samples)
            theirs = direct_light(samples, FILTER_WIDTH)[..., :3]
        for index, (case, is_built) in enumerate(zip(sheet, built, strict=True)):
            if is_built:
                y, x = (SIDE * position + BORDER for position in divmod(index, COLUMNS))
                cell = slice(y, y + SIDE - 2 * BORDER), slice(x, x + SIDE - 2 * BORDER)
                errors[case.name] = float(np.sqrt(np.mean((ours[cell] - theirs[cell]) ** 2)))
        if output is not None:
            beside = np.concatenate([ours, theirs], axis=1)
            opaque = np.concatenate([beside, np.ones_like(beside[..., :1])], axis=2)
            write_png(output / f"nodes-{first // count}.png", display_from_linear(opaque))
    return errors


def arrange(sheet: Sequence[NodeCase]) -> list[bool]:
    """Open a file with an object for each case, from the lower left, and say which of them could be built."""
    scene, built = open_empty_file(), []
    for index, case in enumerate(sheet):
        material = bpy.data.materials.new(case.name)
        built.append(build(case, material))
        y, x = divmod(index, COLUMNS)
        add_object(scene, case.shape, case.name, material, x, y)
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.angle = np.pi, 0.0
    scene.collection.objects.link(sun)
    camera = bpy.data.cameras.new("Camera")
    camera.type, camera.ortho_scale = "ORTHO", COLUMNS
    scene.camera = bpy.data.objects.new("Camera", camera)
    scene.camera.location = (COLUMNS / 2, COLUMNS / 2, 10.0)
    scene.collection.objects.link(scene.camera)
    scene.world = None
    render = scene.render
    render.resolution_x = render.resolution_y = SIDE * COLUMNS
    render.resolution_percentage, render.filter_size = 100, FILTER_WIDTH
    return built


if __name__ == "__main__":
    sys.exit(main())
