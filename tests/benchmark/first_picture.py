# SPDX-License-Identifier: GPL-3.0-or-later
"""When a viewport shows its first picture of materials with nodes: `dev.py bench first_picture`.

In the benchmark's kitchen two sliders are dragged in turns: of one of 40 nodes of a material, and of a material of
constants. Then processes without any shader on disk open the kitchen. In each, the picture is drawn by the render
thread, with the pixels of a viewport's preview.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import bpy

from ism_addon.blender.sync import scene_reader
from ism_addon.blender.viewport.viewport import MAX_PREVIEW_PIXEL_SIZE, next_preview_pixel_size
from ism_addon.gpu.gl.context import open_device
from ism_addon.gpu.jobs.job import Job, Request
from ism_addon.gpu.jobs.render_thread import RenderThread
from ism_addon.scene import Scene, View
from ism_addon.settings import Settings
from tests.docs import record

from .error.benchmark_scene import open_scene

SIZE = 1280, 720  # px
NODES = 40
#: A material of many pixels, which gets the nodes, and one of constants.
WITH_NODES, PLAIN = "Floor boards", "Ceiling paint"
#: Until changes of preview pixels have ended.
WARM_UP = 8

#: Samples of the first change, in which all programs are compiled: a busy machine notices a first picture late.
WARM_UP_SAMPLES = 4


def add_nodes(material: bpy.types.Material, count: int) -> bpy.types.NodeSocket:
    """Give a material a noise texture and a chain of nodes as color. Returns an input of a node amid the chain."""
    tree = material.node_tree
    previous = tree.nodes.new("ShaderNodeTexNoise").outputs["Color"]
    inputs = []
    for index in range(count - 1):
        node = tree.nodes.new(("ShaderNodeGamma", "ShaderNodeHueSaturation", "ShaderNodeBrightContrast")[index % 3])
        tree.links.new(previous, node.inputs["Color"])
        previous = node.outputs[0]
        inputs.append(node.inputs[1])
    principled = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeBsdfPrincipled")
    tree.links.new(previous, principled.inputs["Base Color"])
    return inputs[count // 2 // 3 * 3]


def plain_input(material: bpy.types.Material) -> bpy.types.NodeSocket:
    """The roughness of a material, all nodes of which but the shader are removed."""
    tree = material.node_tree
    for node in list(tree.nodes):
        if node.bl_idname not in ("ShaderNodeBsdfPrincipled", "ShaderNodeOutputMaterial"):
            tree.nodes.remove(node)
    return next(node for node in tree.nodes if node.bl_idname == "ShaderNodeBsdfPrincipled").inputs["Roughness"]


class Viewport:
    """Requests pictures as a viewport does."""

    def __init__(self, view: View):
        self.view, self.thread, self.pixel_size = view, RenderThread(), MAX_PREVIEW_PIXEL_SIZE // 2

    def first_picture(self, scene: Scene) -> Job:
        """Draw a scene until there is a picture."""
        job = self.thread.start(Request(scene, self.view, Settings(), preview_pixel_size=self.pixel_size), "viewport")
        while job.picture() is None and not job.finished:
            job.wait(1.0)
        if job.picture() is None:
            raise RuntimeError(job.error)
        return job

    def adapt(self, job: Job) -> None:
        """Choose the next preview's pixels."""
        self.pixel_size = next_preview_pixel_size(self.pixel_size, job.first_seconds)


@contextmanager
def followed(reader: scene_reader.Reader, scenes: list[Scene]) -> Iterator[None]:
    """Read the scene again after each update."""

    def read(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
        scenes.append(reader.read(depsgraph))

    bpy.app.handlers.depsgraph_update_post.append(read)
    try:
        yield
    finally:
        bpy.app.handlers.depsgraph_update_post.remove(read)


def drag(viewport: Viewport, sliders: dict[str, bpy.types.NodeSocket], rounds: int) -> dict[str, list[dict]]:
    """Of each slider and round: seconds from the change to the first picture, and how many programs are compiled."""
    results: dict[str, list[dict]] = {name: [] for name in sliders}
    reader, scenes = scene_reader.Reader(), list[Scene]()
    viewport.first_picture(reader.read(bpy.context.evaluated_depsgraph_get()))
    with followed(reader, scenes):
        for index in range(rounds + WARM_UP):
            for name, slider in sliders.items():
                start = time.perf_counter()
                slider.default_value = 0.4 + 0.5 * ((index * 7) % 20) / 20.0
                bpy.context.view_layer.update()
                read = time.perf_counter() - start
                job = viewport.first_picture(scenes[-1])
                seconds, compiled = time.perf_counter() - start, job.programs
                needed = WARM_UP_SAMPLES if index == 0 else 1
                while index < WARM_UP and not job.finished and job.samples_done < needed:
                    job.wait(1.0)  # all programs are compiled, and the time of a preview is known
                viewport.adapt(job)
                if index >= WARM_UP:
                    results[name].append({"seconds": seconds, "read": read, "programs": compiled})
    return results


def first_of_file(name: str, size: tuple[int, int]) -> dict[str, float]:
    """Seconds of a file's first picture in this process: to read it, to draw it, and until no graph is left out."""
    with TemporaryDirectory() as folder:
        opened = open_scene(name, 0, size, Path(folder))
    viewport = Viewport(opened.view)
    viewport.thread.expect()
    time.sleep(1.0)  # OpenGL is opened while a scene is read
    start, processor = time.perf_counter(), time.process_time()
    job = viewport.first_picture(opened.scene)
    drawn, processor_drawn = time.perf_counter() - start, time.process_time() - processor
    while job.samples_done == 0 and not job.finished:
        job.wait(1.0)
    whole = time.perf_counter() - start
    viewport.thread.stop()
    return {
        "read": opened.seconds,
        "drawn": drawn,
        "processor": processor_drawn,
        "first sample": whole,
        "graphs": len(opened.scene.graphs),
    }


def without_shaders(name: str, size: tuple[int, int], warm: bool) -> Iterator[dict[str, float]]:
    """Results of processes with an empty shader cache; if `warm`, of a second one with the same cache each."""
    command = [
        sys.executable,
        "-m",
        "tests.benchmark.first_picture",
        "--only",
        name,
        "--size",
        "x".join(map(str, size)),
    ]
    with TemporaryDirectory() as cache:
        for _ in range(1 + warm):
            environment = {**os.environ, "MESA_SHADER_CACHE_DIR": cache}
            output = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=True).stdout
            yield json.loads(output.splitlines()[-1])


def medians(rows: list[dict], names: Callable[[str], bool] = lambda _name: True) -> dict[str, float]:
    """The median of each value."""
    return {name: median(row[name] for row in rows) for name in rows[0] if names(name)}


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.first_picture", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, help="folder of the record")
    parser.add_argument("--rounds", type=int, default=21, help="changes of each slider (%(default)s)")
    parser.add_argument("--processes", type=int, default=5, help="with an empty shader cache (%(default)s)")
    parser.add_argument("--size", default="x".join(map(str, SIZE)), help="WIDTHxHEIGHT in pixels (%(default)s)")
    parser.add_argument("--only", help="print a file's first picture in this process; for the benchmark's processes")
    options = parser.parse_args()
    width, height = map(int, options.size.split("x"))
    if options.only:
        print(json.dumps(first_of_file(options.only, (width, height))))
        return 0
    with TemporaryDirectory() as folder:
        opened = open_scene("kitchen", 0, (width, height), Path(folder))
    sliders = {
        f"one of {NODES} nodes": add_nodes(bpy.data.materials[WITH_NODES], NODES),
        "constants": plain_input(bpy.data.materials[PLAIN]),
    }
    viewport = Viewport(opened.view)
    dragged = drag(viewport, sliders, options.rounds)
    viewport.thread.stop()
    for name, rows in dragged.items():
        print(f"slider of {name:16} first picture {median(row['seconds'] for row in rows):.3f} s", medians(rows))
    pairs = zip(*dragged.values(), strict=True)
    print(f"median ratio of pairs {median(a['seconds'] / b['seconds'] for a, b in pairs):.2f}")
    runs = [tuple(without_shaders("kitchen", (width, height), warm=True)) for _ in range(options.processes)]
    for label, rows in zip(("empty shader cache", "filled shader cache"), zip(*runs, strict=True), strict=True):
        print(label, medians(list(rows)))
    results = {"size": [width, height], "sliders": dragged, "processes": runs}
    if options.output:
        options.output.mkdir(parents=True, exist_ok=True)
        print(record.write(options.output, "first_picture", open_device().name, results))
    return 0


if __name__ == "__main__":
    sys.exit(main())
