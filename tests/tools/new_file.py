# SPDX-License-Identifier: GPL-3.0-or-later
"""New files in Blender, for tests and scenes to start from.

The preferences are kept: loading factory settings would set up all of Blender's add-ons again, 60 ms each time.
"""

import bpy


def open_empty_file() -> bpy.types.Scene:
    """Open Blender's factory startup file without its objects: the scene."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    return bpy.context.scene


def open_factory_file() -> bpy.types.Scene:
    """Open Blender's factory startup file, with a cube, a point light and a camera: the scene."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    return bpy.context.scene
