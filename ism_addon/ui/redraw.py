# SPDX-License-Identifier: GPL-3.0-or-later
"""What an edited setting calls.

Apart from the properties, in a module without bpy: Blender 4.2 never lets go of a property's callback, and Python
cannot end Blender in good order while anything that it cannot let go of leads to bpy.
"""

from typing import Any


def viewports(_group: Any, context: Any) -> None:
    """Draw all 3D viewports again: edits of an add-on's properties do not reach the depsgraph."""
    windows = context.window_manager.windows if context.window_manager else ()
    for window in windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()
