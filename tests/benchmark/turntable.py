# SPDX-License-Identifier: GPL-3.0-or-later
"""Seconds per frame of animations of the demo's atrium, each in its own process: the cost of frames after the first.

The camera, one object or one light rotates. A frame's time is from the end of the previous frame to its own end: the
frame change, our render, and writing the picture, as OpenEXR without compression, so that compression is not measured.
The first frame's time is from the start of the render. It reads the whole scene and compiles the shaders.
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
    return min((each for each in scene.objects if each.type == "MESH"), key=lambda each: len(each.data.polygons))


def light(scene: bpy.types.Scene) -> bpy.types.Object:
    return next(each for each in scene.objects if each.type == "LIGHT")


#: In the name of an animation that is rendered with Blender's Persistent Data.
PERSISTENT = "persistent"

#: The object that rotates, by a degree per frame.
ROTATING = {"camera": camera, "object": mesh, "light": light}


def animate(scene: bpy.types.Scene, target: bpy.types.Object, count: int) -> None:
    """Add keyframes that rotate an object about the world's vertical."""
    target.rotation_mode = "XYZ"
    for frame in (1, count):
        target.rotation_euler.z += 0.0175 * (frame - 1)
        target.keyframe_insert("rotation_euler", frame=frame)
    scene.frame_start, scene.frame_end = 1, count


class Clock:
    """Measures the seconds of each frame, and of parts of it."""

    def __init__(self) -> None:
        self.frames: list[dict] = []
        self.parts: dict[str, float] = {}
        self.since = time.perf_counter()

    @contextmanager
    def timed(self, owner: object, name: str, part: str) -> Iterator[None]:
        """Add the time of each call of owner.name to `part`."""
        original = getattr(owner, name)

        def call(*arguments: object, **named: object) -> object:
            start = time.perf_counter()
            try:
                return original(*arguments, **named)
            finally:
                self.parts[part] = self.parts.get(part, 0.0) + time.perf_counter() - start

        setattr(owner, name, call)
        try:
            yield
        finally:
            setattr(owner, name, original)

    def end_frame(self, *_arguments: object) -> None:
        now = time.perf_counter()
        passes = {name: row["ms"] / 1e3 for name, row in statistics()["passes"].items()}
        self.frames.append({"frame": now - self.since, **self.parts, "drawing": sum(passes.values()), "passes": passes})
        self.parts, self.since = {}, now


@contextmanager
def handler_added(handlers: list, handler: Callable) -> Iterator[None]:
    handlers.append(handler)
    try:
        yield
    finally:
        handlers.remove(handler)


def render_frames() -> list[dict]:
    """Render the open scene's animation. Returns a dict of seconds for each frame."""
    clock = Clock()
    with (
        clock.timed(final_render, "render", "render"),
        clock.timed(persistent_data.LayerCache, "read", "read"),
        clock.timed(final_render, "_fill", "fill"),
        handler_added(bpy.app.handlers.render_write, clock.end_frame),
        quiet_stdout(),
    ):
        clock.since = time.perf_counter()
        bpy.ops.render.render(animation=True)
    return clock.frames


def render_animation(blend: Path, what: str, samples: int, persistent: bool, count: int) -> list[dict]:
    """Render one animation in this process."""
    addon.register()
    try:
        bpy.ops.wm.open_mainfile(filepath=str(blend))
        scene = bpy.context.scene
        scene.render.engine, scene.ism.render.samples = "ISM", samples
        scene.render.resolution_x, scene.render.resolution_y = 1280, 720
        scene.render.use_persistent_data = persistent
        scene.render.image_settings.file_format = "OPEN_EXR"
        scene.render.image_settings.exr_codec = "NONE"
        animate(scene, ROTATING[what](scene), count)
        with TemporaryDirectory() as folder:
            scene.render.filepath = f"{folder}/"
            return render_frames()
    finally:
        addon.unregister()


#: Time of the first frame, of later ones, and its parts: reading the scene, the passes, the rest of our render,
#: passing the result to Blender, and Blender's own time.
COLUMNS = ("first", "later", "read", "draw", "other", "fill", "Blender")


def table_row(name: str, frames: list[dict]) -> str:
    """ms of the first frame, the median of the later ones and of their parts, and the ratio of the two."""
    parts = ("frame", "render", "read", "drawing", "fill")
    frame, render, read, drawing, fill = (median(each[part] for each in frames[1:]) for part in parts)
    first = frames[0]["frame"]
    columns = (first, frame, read, drawing, render - read - drawing - fill, fill, frame - render)
    return f"{name:<24}" + "".join(f"{1e3 * seconds:>9.0f}" for seconds in columns) + f"{frame / first:>8.2f}"


def render_in_process(output: Path, *arguments: str) -> list[dict]:
    """Render one animation in a new process: what rotates, samples, PERSISTENT or nothing, and the number of frames."""
    command = [sys.executable, "-m", __spec__.name, "--output", str(output), "--one", *arguments]
    stdout = subprocess.run(command, capture_output=True, text=True, check=True, timeout=600).stdout
    return json.loads(stdout.splitlines()[-1])


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests.benchmark.turntable", description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, help="folder of the atrium's .blend and of the record")
    parser.add_argument("--frames", default="6", help="frames of each animation (%(default)s)")
    parser.add_argument("--samples", default="1,16", help="numbers of samples, each an animation (%(default)s)")
    parser.add_argument("--what", default=",".join(ROTATING), help="what rotates (%(default)s)")
    parser.add_argument("--one", nargs=4, help=argparse.SUPPRESS)
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    blend = options.output / "atrium.blend"
    if options.one:
        what, samples, persistent, count = options.one
        print(json.dumps(render_animation(blend, what, int(samples), persistent == PERSISTENT, int(count))))
        return 0
    addon.register()
    try:
        saved_atrium(blend)
    finally:
        addon.unregister()
    print(f"{'ms':<24}" + "".join(f"{name:>9}" for name in COLUMNS) + "   ratio")
    results = {}
    for animation in product(options.what.split(","), options.samples.split(","), ("", PERSISTENT)):
        name = ", ".join(filter(None, animation))
        results[name] = render_in_process(options.output, *animation, options.frames)
        print(table_row(name, results[name]), flush=True)
    record.write(options.output, "turntable", open_device().name, {"animations": results})
    return 0


if __name__ == "__main__":
    sys.exit(main())
