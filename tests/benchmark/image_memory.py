# SPDX-License-Identifier: GPL-3.0-or-later
"""The memory that a render of large images takes in addition to Blender's: `dev.py bench image_memory`.

Each file has squares side by side, each with a packed image of its own. A new process opens it and renders one sample.
Blender decodes images when they are first needed, so its memory is measured before and after that. On a software
driver, the memory of this process includes that of textures. It asserts nothing.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

import bpy
import numpy as np

from ism_addon import addon
from ism_addon.gpu.gl.context import open_device
from tests.demo.figure6 import quiet_stdout
from tests.docs import record
from tests.scenes import blend_file
from tests.tools import memory, project

TIMEOUT = 1800  # s, for one case


class Images(NamedTuple):
    """The images of one file."""

    count: int
    side: int  # px
    file_format: str = "PNG"


#: No images, to compare with; the images of the requirement; formats that are read as a whole.
CASES = (
    Images(0, 0),
    Images(3, 4096),
    Images(16, 4096),
    Images(1, 16384),
    Images(3, 4096, "JPEG"),
    Images(3, 4096, "OPEN_EXR"),
    Images(1, 16384, "JPEG"),
)


def build(images: Images, folder: Path) -> Path:
    """Save the file. Returns its path."""
    blend_file.new_file()
    for index in range(images.count):
        corners = np.array([(x + 1.1 * index, y, 0.0) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))])
        material = bpy.data.materials.new(f"Material {index}")
        material.use_nodes = True
        tree = material.node_tree
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = packed_image(index, images, folder)
        tree.links.new(node.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
        mesh = blend_file.large_mesh(f"Square {index}", corners, np.array([[0, 1, 2, 3]]), material)
        mesh.uv_layers.new().uv.foreach_set("vector", np.array([0, 0, 1, 0, 1, 1, 0, 1], np.float32))
        bpy.context.scene.collection.objects.link(bpy.data.objects.new(mesh.name, mesh))
    width = max(1.1 * images.count, 1.0)
    blend_file.add_lights(
        [blend_file.AreaLight("SQUARE", (0.5 * width, 0.5, 5.0), (0.5 * width, 0.5, 0.0), 300, (2, 2))]
    )
    blend_file.add_camera((0.5 * width, 0.5, 1.5 * width), (0.5 * width, 0.5, 0.0), 50.0)
    path = folder / "images.blend"
    blend_file.save(path)
    return path


def packed_image(index: int, images: Images, folder: Path) -> bpy.types.Image:
    """A packed image of blocks of random colours."""
    path, is_float = folder / f"image {index}", images.file_format == "OPEN_EXR"
    image = bpy.data.images.new(path.name, images.side, images.side, float_buffer=is_float)
    blocks = np.random.default_rng(index).random((64, 64, 4), np.float32) + np.float32(1.0) * is_float
    blocks[..., 3] = 1.0
    pixels = blocks.repeat(images.side // 64, 0).repeat(images.side // 64, 1)
    image.pixels.foreach_set(pixels.reshape(-1))
    image.filepath_raw, image.file_format = str(path), images.file_format
    image.save()
    bpy.data.images.remove(image)
    image = bpy.data.images.load(str(path))
    image.pack()
    return image


def measure(path: Path) -> dict[str, float]:
    """Open a file and render one sample. Returns bytes by name."""
    addon.register()
    try:
        with quiet_stdout():
            bpy.ops.wm.open_mainfile(filepath=str(path))
        opened = memory.resident()
        for image in bpy.data.images:
            len(image.pixels)  # Blender decodes its file
        with_pixels = memory.resident()
        for image in bpy.data.images:
            image.buffers_free()
        scene = bpy.context.scene
        scene.render.engine, scene.ism.render.samples = "ISM", 1
        scene.render.filepath = str(path.with_suffix(".png"))
        memory.reset_peak()
        with quiet_stdout():
            bpy.ops.render.render(write_still=True)
        peak = memory.peak()
    finally:
        addon.unregister()
    return {
        "file open": opened,
        "images decoded": with_pixels,
        "peak": peak,
        "after the render": memory.resident(),
    }


def measure_in_processes(images: Images) -> dict[str, float]:
    """Build a file and measure it in new processes, twice: the first one fills the driver's cache of shaders."""
    with tempfile.TemporaryDirectory() as folder:
        arguments = [str(each) for each in images]
        path = in_process("--images", *arguments, "--build", folder)
        for _ in range(2):
            measured = in_process("--measure", path)
    return json.loads(measured)


def in_process(*arguments: str) -> str:
    """Run this module in a new process. Returns the last line that it prints."""
    command = [sys.executable, "-m", "tests.benchmark.image_memory", *arguments]
    return subprocess.check_output(command, cwd=project.ROOT, text=True, timeout=TIMEOUT).splitlines()[-1]


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.image_memory", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, help="folder of the record")
    parser.add_argument("--images", nargs=3, metavar=("COUNT", "SIDE", "FORMAT"), help="only these, such as 3 4096 PNG")
    for step in ("--build", "--measure"):
        parser.add_argument(step, type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    only = Images(int(options.images[0]), int(options.images[1]), options.images[2]) if options.images else None
    if only and options.build:
        print(build(only, options.build))
    elif options.measure:
        print(json.dumps(measure(options.measure)))
    else:
        results = []
        for images in [only] if only else CASES:
            results.append({"images": images._asdict()} | measure_in_processes(images))
            print(*images, {name: f"{value / 1e9:.2f} GB" for name, value in list(results[-1].items())[1:]}, flush=True)
        if options.output:
            options.output.mkdir(parents=True, exist_ok=True)
            record.write(options.output, "image_memory", open_device().name, {"results": results})
    return 0


if __name__ == "__main__":
    sys.exit(main())
