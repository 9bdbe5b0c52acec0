# SPDX-License-Identifier: GPL-3.0-or-later
"""An evaluated depsgraph to one Scene: all that renders, copied, so nothing of bpy outlives the call."""

import bpy

from ..scene import Scene


def scene(depsgraph: bpy.types.Depsgraph) -> Scene:
    """Everything that the depsgraph shows, with a sentence for each kind of thing that was left out."""
    raise NotImplementedError
