# SPDX-License-Identifier: GPL-3.0-or-later
"""Seconds until the first sample of a scene of many small meshes, by turns with Cycles, in one process.

A render is all that Blender takes: its depsgraph, reading the scene, trees, upload, one sample, the result. Nothing is
kept from one to the next. The first of either engine loads programs and compiles shaders, and does not count.
"""

import argparse
import sys
import time
from pathlib import Path
from statistics import median

import bpy
import numpy as np

from ism_addon import addon
from ism_addon.blender.engine import statistics
from ism_addon.blender.render import persistent_data
from ism_addon.gpu.gl.context import open_device
from tests.benchmark.error import cycles
from tests.demo.figure6 import quiet_stdout
from tests.docs import record
from tests.scenes import blend_file
from tests.scenes.blend_file import AreaLight, large_mesh
from tests.scenes.parts.shapes import box

#: m, half of the side of the square that the boxes stand on.
REACH = 4.0

LAMPS = (
    AreaLight("SQUARE", (-3.0, -2.5, 4.5), (0.0, 0.0, 0.0), 300.0, (0.8, 0.8), blend_file.WARM),
    AreaLight("DISK", (3.2, -1.0, 4.0), (0.0, 0.5, 0.0), 200.0, (1.2, 1.2), blend_file.COOL),
)
CAMERA = (0.5, -7.0, 4.0), (0.0, 0.0, 0.0), 34.0


def build(count: int) -> None:
    """Open a scene of so many boxes with a mesh of their own each, on a floor."""
    blend_file.start()
    materials = [bpy.data.materials.new(name) for name in ("Clay", "Teal", "Leaf")]
    side, random = REACH / np.sqrt(count), np.random.default_rng(1)
    stand("Floor", np.array([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)]), np.array([[0, 1, 2, 3]]), materials[0])
    for number, (x, y) in enumerate(random.uniform(-REACH, REACH, (count, 2))):
        shape = box((0.0, 0.0, 0.0), tuple(random.uniform(0.5, 1.5, 3) * side))
        thing = stand(f"Box {number}", shape.positions, shape.quads, materials[number % len(materials)])
        thing.location, thing.rotation_euler = (x, y, 0.0), (0.0, 0.0, random.uniform(0.0, 6.0))
    blend_file.add_lights(LAMPS)
    blend_file.add_camera(*CAMERA)
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = blend_file.SIZE


def stand(name: str, positions: np.ndarray, quads: np.ndarray, material: bpy.types.Material) -> bpy.types.Object:
    thing = bpy.data.objects.new(name, large_mesh(name, positions, quads, material))
    thing.data.shade_flat()
    bpy.context.scene.collection.objects.link(thing)
    return thing


def ours() -> dict[str, float]:
    """Milliseconds of a render, and of its parts: reading, and each pass."""
    scene, read, taken = bpy.context.scene, persistent_data.LayerCache.read, []
    scene.render.engine, scene.ism.render.samples = "ISM", 1

    def timed(*what: object) -> object:
        begin = time.perf_counter()
        found = read(*what)
        taken.append(time.perf_counter() - begin)
        return found

    persistent_data.LayerCache.read = timed
    start = time.perf_counter()
    try:
        with quiet_stdout():
            bpy.ops.render.render()
    finally:
        persistent_data.LayerCache.read = read
    whole = time.perf_counter() - start
    passes = {name: row["ms"] for name, row in statistics()["passes"].items()}
    return {"whole": 1e3 * whole, "read": 1e3 * sum(taken), **passes}


def theirs() -> dict[str, float]:
    """The same of Cycles."""
    cycles.prepare(light_tree=True)
    bpy.context.scene.render.use_persistent_data = False
    return {"Cycles": 1e3 * cycles.render(1, denoise=False, seed=0).whole}


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.small_meshes", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the record")
    parser.add_argument("--meshes", type=int, default=2000, help="of 12 triangles each (%(default)s)")
    parser.add_argument("--renders", type=int, default=5, help="of each engine (%(default)s)")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    addon.register()
    try:
        build(options.meshes)
        rounds = [ours() | theirs() for _ in range(options.renders)]
    finally:
        addon.unregister()
    medians = {name: median(each[name] for each in rounds[1:]) for name in rounds[0]}
    print(f"{'ms':<16}" + "first".rjust(10) + "later".rjust(10))
    for name, value in medians.items():
        if value >= 1.0:
            print(f"{name:<16}{rounds[0][name]:>10.0f}{value:>10.1f}")
    ratio = medians["whole"] / medians["Cycles"]
    print(f"{options.meshes:,} meshes: {ratio:.2f} times Cycles")
    measured = {"meshes": options.meshes, "rounds": rounds}
    record.write(options.output, "small_meshes", open_device().name, measured)
    return 0


if __name__ == "__main__":
    sys.exit(main())
