# SPDX-License-Identifier: GPL-3.0-or-later
"""After many renders and updates of viewports all is as at the start: memory, OpenGL's objects, threads, pace."""

import ctypes
import gc
import random
import statistics
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import bpy
import pytest

from ism_addon import addon
from ism_addon.blender.render import read_settings
from ism_addon.blender.sync import camera, scene_reader
from ism_addon.gpu.jobs.job import Request
from ism_addon.gpu.jobs.render_loop import RenderLoop
from ism_addon.gpu.jobs.render_thread import shared
from tests.tools.memory import resident
from tests.tools.new_file import open_empty_file, open_factory_file

pytestmark = [
    pytest.mark.alone,
    pytest.mark.skipif(sys.platform != "linux", reason="memory is told as on Linux"),
]

MEGABYTE = 1e6
#: Rounds until caches are full, such as the allocator's arenas.
WARM = 30
#: OpenGL's objects that are counted, by names up to this.
KINDS, NAMES = ("Texture", "Buffer", "Framebuffer", "VertexArray", "Program", "Shader"), 5000


@pytest.fixture
def scene() -> Iterator[bpy.types.Scene]:
    """Five things on a floor, two lamps and a camera."""
    addon.register()
    open_empty_file()
    bpy.ops.mesh.primitive_plane_add(size=20.0)
    for across in range(5):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=16, location=(across - 2.0, 0.0, 1.0))
    for across in (-2.0, 2.0):
        bpy.ops.object.light_add(type="AREA", location=(across, 0.0, 6.0))
        bpy.context.object.data.energy = 300.0
    bpy.ops.object.camera_add(location=(0.0, -8.0, 5.0), rotation=(1.0, 0.0, 0.0))
    scene = bpy.context.scene
    scene.camera = bpy.context.object
    scene.render.engine, scene.render.resolution_x, scene.render.resolution_y = "ISM", 96, 54
    scene.ism.render.samples = scene.ism.viewport.samples = 2
    yield scene
    addon.unregister()
    open_factory_file()


def edit(chance: random.Random) -> None:
    """Anything that an artist changes; in the end there is as much as before."""
    thing = chance.choice([thing for thing in bpy.data.objects if thing.type == "MESH" and thing.name != "Plane"])
    lamp = chance.choice(list(bpy.data.lights))
    match chance.randrange(6):
        case 0:
            thing.location = [chance.uniform(-2.0, 2.0) for _ in range(3)]
        case 1:
            thing.scale = [chance.uniform(0.5, 1.5) for _ in range(3)]
        case 2:
            lamp.energy, lamp.size = chance.uniform(100.0, 500.0), chance.uniform(0.1, 2.0)
        case 3:
            for vertex in thing.data.vertices:
                vertex.co.z *= chance.uniform(0.95, 1.05)
            thing.data.update()
        case 4:
            copy = bpy.data.objects.new("Copy", thing.data.copy())
            bpy.context.collection.objects.link(copy)
            bpy.data.meshes.remove(thing.data)
        case 5:
            bpy.context.scene.camera.location.x = chance.uniform(-1.0, 1.0)


class Census(threading.Event):
    """Counts objects of OpenGL in the worker's thread, when it is next asked to draw."""

    count = 0

    def take(self, loop: RenderLoop) -> None:
        load = loop.device.gl.mglo._context.load
        loop.device.free_released()
        tests = [ctypes.CFUNCTYPE(ctypes.c_ubyte, ctypes.c_uint)(load(f"glIs{kind}")) for kind in KINDS]
        self.count = sum(bool(test(name)) for test in tests for name in range(1, NAMES))
        self.set()


@pytest.fixture
def census(monkeypatch) -> Callable[[Callable], int]:
    """census(draw): how many objects there are in OpenGL as something is drawn."""
    asked: list[Census] = []
    tidy = RenderLoop.tidy

    def tidy_and_count(loop: RenderLoop, jobs, forgotten) -> None:
        tidy(loop, jobs, forgotten)
        while asked:
            asked.pop().take(loop)

    monkeypatch.setattr(RenderLoop, "tidy", tidy_and_count)

    def census(draw: Callable[[], None]) -> int:
        taken = Census()
        asked.append(taken)
        draw()
        assert taken.wait(10.0)
        return taken.count

    return census


def threads() -> int:
    """Of this process, Blender's and the driver's too where the system tells."""
    tasks = Path("/proc/self/task")
    return len(list(tasks.iterdir())) if tasks.exists() else threading.active_count()


def soak(
    rounds: int, draw: Callable[[random.Random], None], census, within, finish: Callable[[], None] = lambda: None
) -> None:
    """Draw so many rounds and compare the end with the start, when caches are warm.

    Before each of the two, `finish` draws to its end what is half drawn: how many objects that has is chance.
    """
    chance, seconds = random.Random(1), []

    def state() -> tuple[int, int, int]:
        finish()
        objects = census(lambda: draw(chance))
        gc.collect()
        return resident(), objects, threads()

    for number in range(WARM + rounds):
        if number == WARM:
            memory, objects, running = state()
        before = time.process_time()
        draw(chance)
        seconds.append(time.process_time() - before)
    grown = [after - before for after, before in zip(state(), (memory, objects, running), strict=True)]
    within(grown[0] / MEGABYTE, 20.0)
    within(grown[1], 0)
    within(grown[2], 0)
    half = WARM + rounds // 2
    first, last = statistics.median(seconds[WARM:half]), statistics.median(seconds[half:])
    within(last / first, 1.5)


def test_soak_of_renders(scene, census, within, rounds):
    def render(chance: random.Random) -> None:
        edit(chance)
        assert bpy.ops.render.render() == {"FINISHED"}

    soak(rounds, render, census, within)


def test_soak_of_viewports(scene, census, within, rounds):
    """As a viewport asks: what changed is read, and each job replaces the one before, some of them half drawn."""
    reader, patience = scene_reader.Reader(), random.Random(2)
    job = None

    def update(chance: random.Random) -> None:
        nonlocal job
        edit(chance)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        asked = reader.read(depsgraph), camera.final_view(depsgraph), read_settings.read(scene, "viewport")
        job = shared.start(Request(*asked, preview_pixel_size=patience.choice([1, 4])), "viewport")
        while patience.random() < 0.9 and not job.finished:
            job.wait(0.01)
        assert not job.error

    def finish() -> None:
        while not job.finished:
            job.wait(0.5)

    try:
        soak(rounds, update, census, within, finish)
    finally:
        shared.forget("viewport")
