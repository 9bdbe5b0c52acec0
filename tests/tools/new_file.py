# SPDX-License-Identifier: GPL-3.0-or-later
"""New files in Blender, as tests and scenes start from them.

The preferences stay as they are: factory settings would set up all of Blender's add-ons again, 60 ms each time.
"""

import bpy


def open_empty_file() -> bpy.types.Scene:
    """Open Blender's factory startup file without its objects: the scene."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    return bpy.context.scene


def open_factory_file() -> bpy.types.Scene:
    """Open Blender's factory startup file, a cube under a point light: the scene."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    return bpy.context.scene
