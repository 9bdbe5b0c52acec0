# SPDX-License-Identifier: GPL-3.0-or-later
"""Seconds until a large map of all directions lights a scene, and after it is turned: `dev.py bench large_map`.

A new process opens a file whose world is an OpenEXR image, and renders one sample of it twice. Blender decodes the
image before that, which is measured apart. Virtual machines give memory slowly the first time. So half of the processes
take and free memory before they are measured. It asserts nothing.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

import bpy
import numpy as np

from ism_addon import addon
from ism_addon.blender.engine import statistics
from ism_addon.blender.render import final_render, persistent_data
from ism_addon.gpu.gl.context import open_device
from tests.demo.figure6 import quiet_stdout
from tests.docs import record
from tests.scenes import blend_file

from ..turntable import Clock

TIMEOUT = 600  # s, for one process
#: The passes that make textures and tables of the map.
PASSES = {"textures": "UploadMaterials", "tables": "BakeWorld"}
TURNED_BY = 0.5  # rad
#: Conditions, by the bytes that a process takes and frees before it is measured.
CONDITIONS = {"new memory": 0, "memory at hand": 3 << 30}


def build(width: int, folder: Path) -> Path:
    """Save a file of a few cubes under a map of so many columns and half as many rows. Returns its path."""
    blend_file.new_file()
    path = folder / "map.exr"
    random = np.random.default_rng(1)
    coarse = random.gamma(0.5, 1.0, (32, 64, 4)).astype(np.float32)
    pixels = coarse.repeat(width // 64, 0).repeat(width // 64, 1)
    pixels *= random.random((width // 2, width, 1), np.float32) + np.float32(0.5)
    pixels[..., 3] = 1.0
    row, column = width // 3, width // 5
    pixels[row : row + width // 500, column : column + width // 500] = 2e4  # a sun
    image = bpy.data.images.new(path.name, width, width // 2, float_buffer=True)
    image.pixels.foreach_set(pixels.reshape(-1))
    image.filepath_raw, image.file_format = str(path), "OPEN_EXR"
    image.save()
    bpy.data.images.remove(image)
    world = bpy.context.scene.world = bpy.data.worlds.new("Map")
    world.use_nodes = True
    tree = world.node_tree
    texture, mapping, coordinates = (
        tree.nodes.new(f"ShaderNode{name}") for name in ("TexEnvironment", "Mapping", "TexCoord")
    )
    texture.image = bpy.data.images.load(str(path))
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    for place in ((0.0, 0.0, 1.0), (3.0, 0.0, 1.0), (0.0, 3.0, 1.0)):
        bpy.ops.mesh.primitive_cube_add(location=place)
    bpy.ops.mesh.primitive_plane_add(size=20.0)
    blend_file.add_camera((8.0, -8.0, 5.0), (0.0, 0.0, 1.0), 35.0)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y, scene.render.use_persistent_data = 640, 360, True
    blend = folder / "map.blend"
    blend_file.save(blend)
    return blend


def measure(path: Path, memory: int) -> dict[str, float]:
    """Open a file, render one sample, turn the world and render again. Returns seconds by name.

    `memory`: bytes that are taken and freed before.
    """
    addon.register()
    try:
        with quiet_stdout():
            bpy.ops.wm.open_mainfile(filepath=str(path))
        scene = bpy.context.scene
        scene.render.engine, scene.ism.render.samples = "ISM", 1
        np.ones(memory, np.uint8)
        start = time.perf_counter()
        len(scene.world.node_tree.nodes["Environment Texture"].image.pixels)
        seconds = {"decoded by Blender": time.perf_counter() - start}
        first = timed_render()
        seconds |= {name: first[name] for name in ("read", *PASSES)}
        seconds["read + textures + tables"] = sum(first[name] for name in ("read", *PASSES))
        seconds["first picture"] = first["render"]
        scene.world.node_tree.nodes["Mapping"].inputs["Rotation"].default_value[2] = TURNED_BY
        seconds["first picture after turning it"] = timed_render()["render"]
    finally:
        addon.unregister()
    return seconds


def timed_render() -> dict[str, float]:
    """Seconds of a render and of its parts."""
    clock = Clock()
    with (
        clock.timed(final_render, "render", "render"),
        clock.timed(persistent_data.LayerCache, "read", "read"),
        quiet_stdout(),
    ):
        bpy.ops.render.render()
    passes = {name: row["ms"] / 1e3 for name, row in statistics()["passes"].items()}
    return clock.parts | {name: passes.get(each, 0.0) for name, each in PASSES.items()}


def in_process(*arguments: str) -> str:
    """Run this module in a new process. Returns the last line that it prints."""
    command = [sys.executable, "-m", __spec__.name, *arguments]
    return subprocess.check_output(command, text=True, timeout=TIMEOUT).splitlines()[-1]


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.large_map", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, help="folder of the record")
    parser.add_argument("--width", type=int, default=8192, help="columns of the map (%(default)s)")
    parser.add_argument("--rounds", type=int, default=5, help="processes, whose median is given (%(default)s)")
    parser.add_argument("--memory", type=int, default=0, help=argparse.SUPPRESS)
    for step in ("--build", "--measure"):
        parser.add_argument(step, type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.build:
        print(build(options.width, options.build))
    elif options.measure:
        print(json.dumps(measure(options.measure, options.memory)))
    else:
        with tempfile.TemporaryDirectory() as folder:
            path = in_process("--width", str(options.width), "--build", folder)
            in_process("--measure", path)  # fills the driver's cache of shaders
            rounds: dict[str, list[dict[str, float]]] = {name: [] for name in CONDITIONS}
            for _ in range(options.rounds):
                for name, memory in CONDITIONS.items():
                    seconds = in_process("--memory", str(memory), "--measure", path)
                    rounds[name].append(json.loads(seconds))
        for part in rounds["new memory"][0]:
            medians = (f"{median(each[part] for each in rounds[name]):.2f} s, {name}" for name in CONDITIONS)
            print(f"{part:32}", " · ".join(medians))
        if options.output:
            options.output.mkdir(parents=True, exist_ok=True)
            values = {"width": options.width, "rounds": rounds}
            record.write(options.output, "large_map", open_device().name, values)
    return 0


if __name__ == "__main__":
    sys.exit(main())
