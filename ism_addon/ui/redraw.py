# SPDX-License-Identifier: GPL-3.0-or-later
"""The update callback of the settings.

In a module without bpy: Blender 4.2 never releases a property's callback, and with it the module's globals. If these
held bpy, Python could not shut down cleanly.
"""

from typing import Any


def viewports(_group: Any, context: Any) -> None:
    """Redraw all 3D viewports: edits of an add-on's properties do not reach the depsgraph."""
    windows = context.window_manager.windows if context.window_manager else ()
    for window in windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()
