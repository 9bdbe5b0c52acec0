# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's render and the command line give the same picture of the same scene."""

import subprocess
import sys
from dataclasses import replace

import bpy
import numpy as np
import pytest

from ism_addon import addon, snapshot
from ism_addon.blender.sync import camera, scene_reader
from ism_addon.settings import FINAL, Settings


def read_png(path) -> np.ndarray:
    """The stored pixels, (H,W,4) in 0…255."""
    image = bpy.data.images.load(str(path))
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    width, height = image.size
    return pixels.reshape(height, width, 4) * 255.0


@pytest.mark.parametrize("transparent", [False, True])
def test_blender_and_the_command_line_render_the_same_picture(empty_scene, add, tmp_path, transparent):
    addon.register()
    try:
        bpy.ops.mesh.primitive_plane_add(size=6.0)
        bpy.ops.mesh.primitive_monkey_add(location=(0.0, 0.0, 1.0))
        light = bpy.data.lights.new("lamp", "AREA")
        light.energy, light.size = 150.0, 1.0
        add("lamp", light).location = (0.5, -0.5, 4.0)
        empty_scene.camera = add("camera", bpy.data.cameras.new("camera"))
        empty_scene.camera.location, empty_scene.camera.rotation_euler = (0.0, -6.0, 3.0), (1.2, 0.0, 0.0)
        empty_scene.world = bpy.data.worlds.new("world")
        render = empty_scene.render
        render.engine, render.film_transparent, render.dither_intensity = "ISM", transparent, 0.0
        render.resolution_x, render.resolution_y, render.filepath = 160, 90, str(tmp_path / "blender.png")
        render.image_settings.color_mode = "RGBA"
        empty_scene.view_settings.view_transform = "Standard"
        empty_scene.ism.render.samples = 3
        bpy.ops.render.render(write_still=True)

        depsgraph = bpy.context.evaluated_depsgraph_get()
        settings = Settings(quality=replace(FINAL, samples=3))
        snapshot.save(tmp_path / "scene.npz", scene_reader.scene(depsgraph), camera.final_view(depsgraph), settings)
    finally:
        addon.unregister()
    command = [sys.executable, "-m", "ism_addon.gpu", tmp_path / "scene.npz", "-o", tmp_path / "line.png"]
    subprocess.run(command, check=True)
    in_blender, by_command_line = read_png(tmp_path / "blender.png"), read_png(tmp_path / "line.png")
    assert np.ptp(in_blender[..., :3]) > 100.0
    assert np.abs(in_blender - by_command_line).max() <= 1.001
