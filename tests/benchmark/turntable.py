# SPDX-License-Identifier: GPL-3.0-or-later
"""Seconds a frame of animations of the demo's atrium, in a process of their own each: what a later frame still costs.

The camera turns, one object turns, or a light moves. A frame's time is all that Blender takes from the end of the one
before to its own: the frame change, our render, and writing the picture, as OpenEXR without compression, lest that be
what is measured. The first frame counts from the render's begin; it reads all and compiles the shaders.
"""

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import product
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

import bpy

from ism_addon import addon
from ism_addon.blender.engine import statistics
from ism_addon.blender.render import final_render, persistent_data
from ism_addon.gpu.gl.context import open_device
from tests.demo.figure6 import quiet_stdout, saved_atrium
from tests.docs import record


def camera(scene: bpy.types.Scene) -> bpy.types.Object:
    return scene.camera


def mesh(scene: bpy.types.Scene) -> bpy.types.Object:
    return min((thing for thing in scene.objects if thing.type == "MESH"), key=lambda thing: len(thing.data.polygons))


def light(scene: bpy.types.Scene) -> bpy.types.Object:
    return next(thing for thing in scene.objects if thing.type == "LIGHT")


#: What an animation is called that has Blender keep its data.
PERSISTENT = "persistent"

#: What turns, a degree a frame.
TURNED = {"camera": camera, "object": mesh, "light": light}


def animate(scene: bpy.types.Scene, thing: bpy.types.Object, count: int) -> None:
    """Turn it about the world's vertical."""
    thing.rotation_mode = "XYZ"
    for frame in (1, count):
        thing.rotation_euler.z += 0.0175 * (frame - 1)
        thing.keyframe_insert("rotation_euler", frame=frame)
    scene.frame_start, scene.frame_end = 1, count


class Clock:
    """Seconds of one frame's parts."""

    def __init__(self) -> None:
        self.frames: list[dict] = []
        self.parts: dict[str, float] = {}
        self.since = time.perf_counter()

    @contextmanager
    def timed(self, owner: object, name: str, part: str) -> Iterator[None]:
        """Count each call of owner.name as `part`."""
        kept = getattr(owner, name)

        def call(*arguments: object, **named: object) -> object:
            start = time.perf_counter()
            try:
                return kept(*arguments, **named)
            finally:
                self.parts[part] = self.parts.get(part, 0.0) + time.perf_counter() - start

        setattr(owner, name, call)
        try:
            yield
        finally:
            setattr(owner, name, kept)

    def end_frame(self, *_what: object) -> None:
        now = time.perf_counter()
        passes = {name: row["ms"] / 1e3 for name, row in statistics()["passes"].items()}
        self.frames.append({"frame": now - self.since, **self.parts, "drawing": sum(passes.values()), "passes": passes})
        self.parts, self.since = {}, now


@contextmanager
def handled(handlers: list, handler: Callable) -> Iterator[None]:
    handlers.append(handler)
    try:
        yield
    finally:
        handlers.remove(handler)


def measured(count: int) -> list[dict]:
    """Render the open scene's animation: a dict of seconds a frame."""
    clock = Clock()
    with (
        clock.timed(final_render, "render", "render"),
        clock.timed(persistent_data.LayerCache, "read", "read"),
        clock.timed(final_render, "_fill", "fill"),
        handled(bpy.app.handlers.render_write, clock.end_frame),
        quiet_stdout(),
    ):
        clock.since = time.perf_counter()
        bpy.ops.render.render(animation=True)
    return clock.frames


def turn(blend: Path, what: str, samples: int, persistent: bool, count: int) -> list[dict]:
    """One animation, here and now."""
    addon.register()
    try:
        bpy.ops.wm.open_mainfile(filepath=str(blend))
        scene = bpy.context.scene
        scene.render.engine, scene.ism.render.samples = "ISM", samples
        scene.render.resolution_x, scene.render.resolution_y = 1280, 720
        scene.render.use_persistent_data = persistent
        scene.render.image_settings.file_format = "OPEN_EXR"
        scene.render.image_settings.exr_codec = "NONE"
        animate(scene, TURNED[what](scene), count)
        with TemporaryDirectory() as folder:
            scene.render.filepath = f"{folder}/"
            return measured(count)
    finally:
        addon.unregister()


#: Of a frame's time: reading the scene, the passes, waiting for them and between them, handing over, and Blender's own.
COLUMNS = ("first", "later", "read", "draw", "other", "fill", "Blender")


def row(name: str, frames: list[dict]) -> str:
    """ms of the first frame and the median of the later ones, where that goes, and the ratio of the two."""
    names = ("frame", "render", "read", "drawing", "fill")
    frame, render, read, drawing, fill = (median(each[part] for each in frames[1:]) for part in names)
    first = frames[0]["frame"]
    parts = (first, frame, read, drawing, render - read - drawing - fill, fill, frame - render)
    return f"{name:<24}" + "".join(f"{1e3 * seconds:>9.0f}" for seconds in parts) + f"{frame / first:>8.2f}"


def of_its_own(output: Path, *what: str) -> list[dict]:
    """The same in a process of its own: what turns, samples, whether data is persistent, and frames."""
    command = [sys.executable, "-m", __spec__.name, "--output", str(output), "--one", *what]
    said = subprocess.run(command, capture_output=True, text=True, check=True, timeout=600).stdout
    return json.loads(said.splitlines()[-1])


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.turntable", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the atrium's .blend and of the record")
    parser.add_argument("--frames", default="6", help="of each animation (%(default)s)")
    parser.add_argument("--samples", default="1,16", help="one animation for each number (%(default)s)")
    parser.add_argument("--what", default=",".join(TURNED), help="what turns (%(default)s)")
    parser.add_argument("--one", nargs=4, help=argparse.SUPPRESS)
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    blend = options.output / "atrium.blend"
    if options.one:
        what, samples, kept, count = options.one
        print(json.dumps(turn(blend, what, int(samples), kept == PERSISTENT, int(count))))
        return 0
    addon.register()
    try:
        saved_atrium(blend)
    finally:
        addon.unregister()
    print(f"{'ms':<24}" + "".join(f"{name:>9}" for name in COLUMNS) + "   ratio")
    found = {}
    for animation in product(options.what.split(","), options.samples.split(","), ("", PERSISTENT)):
        name = ", ".join(filter(None, animation))
        found[name] = of_its_own(options.output, *animation, options.frames)
        print(row(name, found[name]), flush=True)
    record.write(options.output, "turntable", open_device().name, {"animations": found})
    return 0


if __name__ == "__main__":
    sys.exit(main())
