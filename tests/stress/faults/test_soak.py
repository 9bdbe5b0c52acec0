# SPDX-License-Identifier: GPL-3.0-or-later
"""Many renders or viewport updates leak no memory, OpenGL objects or threads, and become no slower."""

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

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="memory is measured as on Linux")

MEGABYTE = 1e6
#: Repetitions until caches are full, such as the allocator's arenas, and programs for lights that are seldom faint.
WARM_UP = 100
#: Types of OpenGL objects that are counted, and the end of the range of their names (integers) that is tried.
OBJECT_TYPES, NAME_LIMIT = ("Texture", "Buffer", "Framebuffer", "VertexArray", "Program", "Shader"), 5000


@pytest.fixture
def scene() -> Iterator[bpy.types.Scene]:
    """Five spheres on a floor, two lights and a camera."""
    addon.register()
    open_empty_file()
    bpy.ops.mesh.primitive_plane_add(size=20.0)
    for x in range(5):
        bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=16, location=(x - 2.0, 0.0, 1.0))
    for x in (-2.0, 2.0):
        bpy.ops.object.light_add(type="AREA", location=(x, 0.0, 6.0))
        bpy.context.object.data.energy = 300.0
    bpy.ops.object.camera_add(location=(0.0, -8.0, 5.0), rotation=(1.0, 0.0, 0.0))
    scene = bpy.context.scene
    scene.camera = bpy.context.object
    scene.render.engine, scene.render.resolution_x, scene.render.resolution_y = "ISM", 96, 54
    scene.ism.render.samples = scene.ism.viewport.samples = 2
    yield scene
    addon.unregister()
    open_factory_file()


def edit(rng: random.Random) -> None:
    """Change a random property of a random object; the amount of data stays the same."""
    sphere = rng.choice([each for each in bpy.data.objects if each.type == "MESH" and each.name != "Plane"])
    light = rng.choice(list(bpy.data.lights))
    match rng.randrange(6):
        case 0:
            sphere.location = [rng.uniform(-2.0, 2.0) for _ in range(3)]
        case 1:
            sphere.scale = [rng.uniform(0.5, 1.5) for _ in range(3)]
        case 2:
            light.energy, light.size = rng.uniform(100.0, 500.0), rng.uniform(0.1, 2.0)
        case 3:
            for vertex in sphere.data.vertices:
                vertex.co.z *= rng.uniform(0.95, 1.05)
            sphere.data.update()
        case 4:
            copy = bpy.data.objects.new("Copy", sphere.data.copy())
            bpy.context.collection.objects.link(copy)
            bpy.data.meshes.remove(sphere.data)
        case 5:
            bpy.context.scene.camera.location.x = rng.uniform(-1.0, 1.0)


class ObjectCount(threading.Event):
    """The number of OpenGL objects, once the render thread has counted them."""

    count = 0

    def take(self, loop: RenderLoop) -> None:
        """Count in the render thread, where the context is current."""
        load = loop.device.gl.mglo._context.load
        loop.device.free_released()
        prototype = ctypes.CFUNCTYPE(ctypes.c_ubyte, ctypes.c_uint)
        is_object = [prototype(load(f"glIs{object_type}")) for object_type in OBJECT_TYPES]
        self.count = sum(bool(test(name)) for test in is_object for name in range(1, NAME_LIMIT))
        self.set()


@pytest.fixture
def count_objects(monkeypatch) -> Callable[[Callable], int]:
    """count_objects(draw): the number of OpenGL objects during draw()."""
    pending: list[ObjectCount] = []
    tidy = RenderLoop.tidy

    def tidy_and_count(loop: RenderLoop, jobs, forgotten) -> None:
        tidy(loop, jobs, forgotten)
        while pending:
            pending.pop().take(loop)

    monkeypatch.setattr(RenderLoop, "tidy", tidy_and_count)

    def count_objects(draw: Callable[[], None]) -> int:
        counted = ObjectCount()
        pending.append(counted)
        draw()
        assert counted.wait(10.0)
        return counted.count

    return count_objects


def thread_count() -> int:
    """Threads of this process, where possible with those of Blender and the driver."""
    tasks = Path("/proc/self/task")
    return len(list(tasks.iterdir())) if tasks.exists() else threading.active_count()


def soak(
    repetitions: int,
    draw: Callable[[random.Random], None],
    count_objects,
    assert_within,
    finish: Callable[[], None] = lambda: None,
) -> None:
    """Draw repeatedly, and compare the state at the end with that after the warm-up.

    Before each state is taken, `finish` completes an unfinished job, whose number of objects would be random.
    """
    rng, seconds = random.Random(1), []

    def state() -> tuple[int, int, int]:
        finish()
        objects = count_objects(lambda: draw(rng))
        gc.collect()
        return resident(), objects, thread_count()

    for repetition in range(WARM_UP + repetitions):
        if repetition == WARM_UP:
            memory, objects, threads = state()
        before = time.process_time()
        draw(rng)
        seconds.append(time.process_time() - before)
    growth = [after - before for after, before in zip(state(), (memory, objects, threads), strict=True)]
    assert_within(growth[0] / MEGABYTE, 20.0)
    assert_within(growth[1], 0)
    assert_within(growth[2], 0)
    half = WARM_UP + repetitions // 2
    first, last = statistics.median(seconds[WARM_UP:half]), statistics.median(seconds[half:])
    assert_within(last / first, 1.5)


def test_soak_of_renders(scene, count_objects, assert_within, repetitions):
    def render(rng: random.Random) -> None:
        edit(rng)
        assert bpy.ops.render.render() == {"FINISHED"}

    soak(repetitions, render, count_objects, assert_within)


def test_soak_of_viewports(scene, count_objects, assert_within, repetitions):
    """As a viewport does: changes are read, and each job replaces the one before, which may be unfinished."""
    reader, patience_rng = scene_reader.Reader(), random.Random(2)
    job = None

    def update(rng: random.Random) -> None:
        nonlocal job
        edit(rng)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        arguments = reader.read(depsgraph), camera.final_view(depsgraph), read_settings.read(scene, "viewport")
        job = shared.start(Request(*arguments, preview_pixel_size=patience_rng.choice([1, 4])), "viewport")
        while patience_rng.random() < 0.9 and not job.finished:
            job.wait(0.01)
        assert not job.error

    def finish() -> None:
        while not job.finished:
            job.wait(0.5)

    try:
        soak(repetitions, update, count_objects, assert_within, finish)
    finally:
        shared.forget("viewport")
