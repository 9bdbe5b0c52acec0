# SPDX-License-Identifier: GPL-3.0-or-later
"""A render engine that does nothing: what Blender itself takes for a redraw."""

from collections.abc import Iterator
from contextlib import contextmanager

import bpy


class BlankRenderEngine(bpy.types.RenderEngine):
    """Its viewport stays empty."""

    bl_idname = "ISM_TEST_BLANK"
    bl_label = "Blank"

    def view_update(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        pass

    def view_draw(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        pass


@contextmanager
def engine() -> Iterator[str]:
    """Its name, as long as it is there."""
    bpy.utils.register_class(BlankRenderEngine)
    yield BlankRenderEngine.bl_idname
    bpy.utils.unregister_class(BlankRenderEngine)
