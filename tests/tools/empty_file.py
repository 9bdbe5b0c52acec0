# SPDX-License-Identifier: GPL-3.0-or-later
"""A new file with nothing in it, as tests and scenes start from."""

import bpy


def open_empty_file() -> bpy.types.Scene:
    """Open Blender's factory startup file without its objects: the scene.

    The preferences stay as they are: factory settings would set up all of Blender's add-ons again, 60 ms each time.
    """
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    return bpy.context.scene
