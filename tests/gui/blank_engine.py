# SPDX-License-Identifier: GPL-3.0-or-later
"""A render engine that does nothing: with it, a redraw takes the time that Blender itself needs."""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy


class BlankRenderEngine(bpy.types.RenderEngine):
    """Leaves its viewport empty."""

    bl_idname = "ISM_TEST_BLANK"
    bl_label = "Blank"

    def view_update(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        pass

    def view_draw(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        pass


@contextmanager
def registered() -> Iterator[str]:
    """Register the engine inside this with-block: its bl_idname."""
    bpy.utils.register_class(BlankRenderEngine)
    yield BlankRenderEngine.bl_idname
    bpy.utils.unregister_class(BlankRenderEngine)
