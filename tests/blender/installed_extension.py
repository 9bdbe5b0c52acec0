# SPDX-License-Identifier: GPL-3.0-or-later
"""Run by test_extension in a Blender of its own: installs a zip, renders, and prints a report as JSON."""

import json
import sys
import threading
from pathlib import Path

import bpy
import numpy as np

archive, picture = sys.argv[-2:]
bpy.ops.extensions.package_install_files(filepath=archive, repo="user_default", enable_on_install=True)
packages_early = sorted({"moderngl", "glcontext"} & set(sys.modules))
readers = (".sync.scene_reader", ".render.final_render", ".viewport.viewport", ".snapshot")
readers_early = sorted(name for name in sys.modules if name.endswith(readers))
threads_early = [thread.name for thread in threading.enumerate() if thread is not threading.main_thread()]

# Blender puts the extension's packages last, behind those of a virtual environment with the same names.
user = bpy.utils.resource_path("USER")
sys.path.sort(key=lambda path: not Path(path).is_relative_to(user))

scene = bpy.context.scene
bpy.data.lights[0].type = "AREA"
bpy.data.lights[0].size = 2.0
scene.render.engine = "ISM"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 48, 32, 100
scene.ism.render.samples, scene.ism.render.virtual_lights = 1, 8
scene.render.filepath = picture
bpy.ops.render.render(write_still=True)

image = bpy.data.images.load(picture)
pixels = np.empty(len(image.pixels), np.float32)
image.pixels.foreach_get(pixels)
print(
    json.dumps(
        {
            "packages before the first picture": packages_early,
            "readers before the first picture": readers_early,
            "threads before the first picture": threads_early,
            "moderngl": sys.modules["moderngl"].__file__,
            "user": user,
            "brightest": float(pixels.reshape(-1, 4)[:, :3].max()),
            "darkest": float(pixels.reshape(-1, 4)[:, :3].min()),
            "size": list(image.size),
        }
    )
)
