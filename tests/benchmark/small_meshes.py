# SPDX-License-Identifier: GPL-3.0-or-later
"""Render times of one sample of a scene of many small meshes, alternating with Cycles in one process.

The time is that of the whole render: depsgraph, reading the scene, BVHs, upload, one sample, the result. Nothing is
kept between renders. The first render of each engine loads programs and compiles shaders, and is not counted.
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

#: m, half the side of the square that the boxes stand on.
HALF_WIDTH = 4.0

LIGHTS = (
    AreaLight("SQUARE", (-3.0, -2.5, 4.5), (0.0, 0.0, 0.0), 300.0, (0.8, 0.8), blend_file.WARM),
    AreaLight("DISK", (3.2, -1.0, 4.0), (0.0, 0.5, 0.0), 200.0, (1.2, 1.2), blend_file.COOL),
)
CAMERA = (0.5, -7.0, 4.0), (0.0, 0.0, 0.0), 34.0


def build(count: int) -> None:
    """Open a scene of `count` boxes on a floor. Each box has its own mesh."""
    blend_file.new_file()
    materials = [bpy.data.materials.new(name) for name in ("Clay", "Teal", "Leaf")]
    side, random = HALF_WIDTH / np.sqrt(count), np.random.default_rng(1)
    add_object(
        "Floor", np.array([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)]), np.array([[0, 1, 2, 3]]), materials[0]
    )
    for index, (x, y) in enumerate(random.uniform(-HALF_WIDTH, HALF_WIDTH, (count, 2))):
        shape = box((0.0, 0.0, 0.0), tuple(random.uniform(0.5, 1.5, 3) * side))
        box_object = add_object(f"Box {index}", shape.positions, shape.quads, materials[index % len(materials)])
        box_object.location, box_object.rotation_euler = (x, y, 0.0), (0.0, 0.0, random.uniform(0.0, 6.0))
    blend_file.add_lights(LIGHTS)
    blend_file.add_camera(*CAMERA)
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = blend_file.SIZE


def add_object(name: str, positions: np.ndarray, quads: np.ndarray, material: bpy.types.Material) -> bpy.types.Object:
    added = bpy.data.objects.new(name, large_mesh(name, positions, quads, material))
    added.data.shade_flat()
    bpy.context.scene.collection.objects.link(added)
    return added


def render_ism() -> dict[str, float]:
    """Render with our engine. Returns milliseconds: of the whole, of reading the scene, and of each pass."""
    scene, read, read_times = bpy.context.scene, persistent_data.LayerCache.read, []
    scene.render.engine, scene.ism.render.samples = "ISM", 1

    def timed_read(*arguments: object) -> object:
        read_start = time.perf_counter()
        result = read(*arguments)
        read_times.append(time.perf_counter() - read_start)
        return result

    persistent_data.LayerCache.read = timed_read
    start = time.perf_counter()
    try:
        with quiet_stdout():
            bpy.ops.render.render()
    finally:
        persistent_data.LayerCache.read = read
    total = time.perf_counter() - start
    passes = {name: row["ms"] for name, row in statistics()["passes"].items()}
    return {"whole": 1e3 * total, "read": 1e3 * sum(read_times), **passes}


def render_cycles() -> dict[str, float]:
    """Render with Cycles. Returns milliseconds."""
    cycles.prepare(light_tree=True)
    bpy.context.scene.render.use_persistent_data = False
    return {"Cycles": 1e3 * cycles.render(1, denoise=False, seed=0).total}


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.small_meshes", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the record")
    parser.add_argument("--meshes", type=int, default=2000, help="meshes of 12 triangles each (%(default)s)")
    parser.add_argument("--renders", type=int, default=5, help="renders by each engine (%(default)s)")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    addon.register()
    try:
        build(options.meshes)
        rounds = [render_ism() | render_cycles() for _ in range(options.renders)]
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
