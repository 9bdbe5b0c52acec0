# SPDX-License-Identifier: GPL-3.0-or-later
"""One picture, in a process of its own so that the peak of memory is its own: prints what it took as JSON.

Times are of reading the scene and of the passes; a small picture before has compiled the shaders. Memory is what comes
on top of Blender with the scene open, the shaders and OpenGL itself included.
"""

import json
import math
import sys
import time
from dataclasses import replace

import bpy
import numpy as np

from ism_addon.blender.render import persistent_data
from ism_addon.blender.sync import camera
from ism_addon.blender.sync.scene_reader import accept_all
from ism_addon.gpu.estimators import DIRECT
from ism_addon.gpu.gl.context import Device, open_device
from ism_addon.gpu.profile import Profile
from ism_addon.gpu.renderer import Renderer
from ism_addon.scene import Scene, View
from ism_addon.settings import Method, Settings
from tests.demo.figure6 import quiet_stdout
from tests.tools import memory

from . import scene as benchmark_scene
from .series import SAMPLES, SERIES, Picture

TREES = ("BuildBLAS", "UploadBLAS", "BuildTLAS")
SHADOWS = tuple(kind.__name__ for kind in DIRECT[Method.RAY_TRACED].pass_types)
UPLOADS = ("UploadMeshes", "UploadUVs", "UploadInstances", "UploadMaterials")


def measure(picture: Picture) -> dict:
    """Seconds, milliseconds and bytes by name."""
    small = replace(picture, triangles=1000, objects=min(picture.objects, 4), frames=0)
    depsgraph = opened(small)
    empty = memory.resident()
    device = open_device()
    drawn(device, depsgraph, small)
    device.free_released()
    opengl = memory.resident() - empty
    depsgraph = opened(picture)
    before = memory.resident()
    memory.reset_peak()
    told = drawn(device, depsgraph, picture)
    return told | {"peak bytes": memory.peak() - before + opengl, "opengl bytes": opengl}


def opened(picture: Picture) -> bpy.types.Depsgraph:
    """Its scene, evaluated."""
    with quiet_stdout():
        benchmark_scene.build(picture.triangles, picture.objects, picture.lamps)
    if picture.ssao_radius is not None:
        benchmark_scene.add_world_light()
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = picture.size
    return bpy.context.evaluated_depsgraph_get()


def drawn(device: Device, depsgraph: bpy.types.Depsgraph, picture: Picture) -> dict:
    """All frames, and after the first its first sample once more, which finds the trees kept."""
    layer, renderer, settings = persistent_data.LayerCache(), Renderer(device), picture.settings()
    start = time.perf_counter()
    scene, view = layer.read(depsgraph, accept_all), camera.final_view(depsgraph)
    told = {"triangles": scene.triangle_count, "reading s": time.perf_counter() - start, "reading bytes": memory.peak()}
    rows, first = sample(renderer, scene, view, settings, 0)
    told |= {
        "first sync s": told["reading s"] + sum(rows.get(name, 0.0) for name in UPLOADS) / 1e3,
        "trees ms": sum(rows.get(name, 0.0) for name in TREES),
        "shadows ms": sum(rows.get(name, 0.0) for name in (*TREES, *SHADOWS)),
        "first sample s": first,
        "passes ms": rows,
    }
    further = [sample(renderer, scene, view, settings, number)[1] for number in range(1, SAMPLES)]
    told["further sample s"] = float(np.median(further))
    renderer.picture()
    again, _ = sample(renderer, scene, beside(view), settings, 0)
    told["shadows again ms"] = sum(again.get(name, 0.0) for name in SHADOWS)
    if picture.frames:
        told["a frame s"] = seconds_a_frame(renderer, layer, settings, picture.frames)
    renderer.release()
    return told


def seconds_a_frame(renderer: Renderer, layer: persistent_data.LayerCache, settings: Settings, count: int) -> float:
    """Of a camera that goes around the scene, reading included."""
    start = time.perf_counter()
    for number in range(count):
        benchmark_scene.turn(2.0 * math.pi * number / count)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        scene, view = layer.read(depsgraph, accept_all), camera.final_view(depsgraph)
        for k in range(SAMPLES):
            sample(renderer, scene, view, settings, k)
        renderer.picture()
    return (time.perf_counter() - start) / count


def sample(
    renderer: Renderer, scene: Scene, view: View, settings: Settings, number: int
) -> tuple[dict[str, float], float]:
    """Draw it: milliseconds by pass, and seconds of all."""
    start, profile = time.perf_counter(), Profile()
    for _ in renderer.sample(scene, view, settings, number, profile):
        pass
    return {name: row.ms for name, row in profile.rows.items() if row.drawn}, time.perf_counter() - start


def beside(view: View) -> View:
    """The same picture by a matrix that is not the same: all that depends on it is drawn anew."""
    return replace(view, clip_from_view=(1.0 + 1e-6) * view.clip_from_view)


if __name__ == "__main__":
    name, value = sys.argv[1:]
    print(json.dumps(measure(SERIES[name].picture(int(value)))))
