# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures one picture in its own process, so that the peak memory is its own. Prints the result as JSON.

Times are of reading the scene and of the passes; a small picture has compiled the shaders before. Memory is in addition
to that of Blender with the scene open, and includes shaders and OpenGL itself.
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

BVH_PASSES = ("BuildBLAS", "UploadBLAS", "BuildTLAS")
SHADOWS = tuple(pass_type.__name__ for pass_type in DIRECT[Method.RAY_TRACED].pass_types)
UPLOADS = ("UploadMeshes", "UploadUVs", "UploadInstances", "UploadMaterials")


def measure(picture: Picture) -> dict:
    """Measure a picture. Returns seconds, milliseconds and bytes by name."""
    small = replace(picture, triangles=1000, objects=min(picture.objects, 4), frames=0)
    depsgraph = open_scene(small)
    empty = memory.resident()
    device = open_device()
    draw(device, depsgraph, small)
    device.free_released()
    opengl = memory.resident() - empty
    depsgraph = open_scene(picture)
    before = memory.resident()
    memory.reset_peak()
    result = draw(device, depsgraph, picture)
    return result | {"peak bytes": memory.peak() - before + opengl, "opengl bytes": opengl}


def open_scene(picture: Picture) -> bpy.types.Depsgraph:
    """Open the picture's scene. Returns its evaluated depsgraph."""
    with quiet_stdout():
        benchmark_scene.build(picture.triangles, picture.objects, picture.lights)
    if picture.ssao_radius is not None:
        benchmark_scene.add_world_light()
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = picture.size
    return bpy.context.evaluated_depsgraph_get()


def draw(device: Device, depsgraph: bpy.types.Depsgraph, picture: Picture) -> dict:
    """Draw the picture, its first sample again with the BVHs kept, and the frames. Returns times and bytes by name."""
    layer, renderer, settings = persistent_data.LayerCache(), Renderer(device), picture.settings()
    start = time.perf_counter()
    scene, view = layer.read(depsgraph, accept_all), camera.final_view(depsgraph)
    reading = time.perf_counter() - start
    result = {"triangles": scene.triangle_count, "reading s": reading, "reading bytes": memory.peak()}
    rows, first = sample(renderer, scene, view, settings, 0)
    result |= {
        "first sync s": reading + sum(rows.get(name, 0.0) for name in UPLOADS) / 1e3,
        "BVH ms": sum(rows.get(name, 0.0) for name in BVH_PASSES),
        "shadows ms": sum(rows.get(name, 0.0) for name in (*BVH_PASSES, *SHADOWS)),
        "first sample s": first,
        "passes ms": rows,
    }
    further = [sample(renderer, scene, view, settings, index)[1] for index in range(1, SAMPLES)]
    result["further sample s"] = float(np.median(further))
    renderer.picture()
    again, _ = sample(renderer, scene, perturbed(view), settings, 0)
    result["shadows again ms"] = sum(again.get(name, 0.0) for name in SHADOWS)
    if picture.frames:
        result["a frame s"] = seconds_per_frame(renderer, layer, settings, picture.frames)
    renderer.release()
    return result


def seconds_per_frame(renderer: Renderer, layer: persistent_data.LayerCache, settings: Settings, count: int) -> float:
    """Draw frames of a camera that orbits the scene. Returns seconds per frame, reading included."""
    start = time.perf_counter()
    for frame in range(count):
        benchmark_scene.orbit_camera(2.0 * math.pi * frame / count)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        scene, view = layer.read(depsgraph, accept_all), camera.final_view(depsgraph)
        for index in range(SAMPLES):
            sample(renderer, scene, view, settings, index)
        renderer.picture()
    return (time.perf_counter() - start) / count


def sample(
    renderer: Renderer, scene: Scene, view: View, settings: Settings, index: int
) -> tuple[dict[str, float], float]:
    """Draw one sample. Returns milliseconds by pass, and the seconds of all passes."""
    start, profile = time.perf_counter(), Profile()
    for _ in renderer.sample(scene, view, settings, index, profile):
        pass
    return {name: row.ms for name, row in profile.rows.items() if row.drawn}, time.perf_counter() - start


def perturbed(view: View) -> View:
    """The same picture by a slightly different matrix, so that no result that depends on it is reused."""
    return replace(view, clip_from_view=(1.0 + 1e-6) * view.clip_from_view)


if __name__ == "__main__":
    name, value = sys.argv[1:]
    print(json.dumps(measure(SERIES[name].picture(int(value)))))
