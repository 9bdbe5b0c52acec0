# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine, as Blender calls it. `final_render` and `viewport` do the work.

They are imported when they are first needed, so that Blender starts faster: most files use other engines.
"""

from importlib.machinery import ExtensionFileLoader
from typing import TYPE_CHECKING, Any

import bpy
from bpy.app.handlers import persistent

from ..gpu.jobs.render_thread import shared
from ..render_passes import enabled
from . import app_handlers
from .render import persistent_data, render_statistics
from .viewport import redraw_timer

if TYPE_CHECKING:
    from .viewport.viewport import Viewport

__all__ = ["IS_BPY_MODULE", "ISMRenderEngine", "is_rendering", "register", "statistics", "stop", "unregister"]

#: Whether Blender is the Python module bpy.
IS_BPY_MODULE = isinstance(bpy.__spec__.loader, ExtensionFileLoader)


#: One entry for each running render: a handler can start another one.
_rendering: list[str] = []


class ISMRenderEngine(bpy.types.RenderEngine):
    """Ray traced soft shadows of area, point and spot lights, and screen-space ambient occlusion."""

    bl_idname = "ISM"
    bl_label = "ISM"
    bl_use_preview = True
    bl_use_eevee_viewport = True  # for Material Preview, which would be empty
    bl_use_shading_nodes_custom = False  # True would hide Blender's own material nodes

    _viewport: Any = None  # a Viewport; Blender would resolve that annotation immediately

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)

    def update_render_passes(self, scene: bpy.types.Scene, renderlayer: bpy.types.ViewLayer) -> None:
        for each in enabled(renderlayer):
            self.register_pass(scene, renderlayer, each.name, len(each.channels), each.channels, each.kind)

    def render(self, depsgraph: bpy.types.Depsgraph) -> None:
        from .render import final_render

        _rendering.append(self.bl_idname)
        try:
            final_render.render(self, depsgraph)
        except KeyboardInterrupt:  # of the bpy module; in Blender, Ctrl+C is Escape
            self.report({"ERROR"}, "The render was interrupted")
        except Exception as error:
            self.report({"ERROR"}, f"The picture could not be made: {error}")
            raise
        finally:
            _rendering.pop()

    def view_update(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        self._get_viewport().update(context, depsgraph)
        self.tag_redraw()  # after a script's edit, Blender may not redraw by itself

    def view_draw(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        self._get_viewport().draw(self, context, depsgraph)

    @staticmethod
    def latest_statistics() -> tuple[str, dict]:
        """See render_statistics.latest. For the panels, which find the engine by its name."""
        return render_statistics.latest()

    def _get_viewport(self) -> "Viewport":
        if self._viewport is None:
            from .viewport.viewport import Viewport

            self._viewport = Viewport()
        return self._viewport


def statistics() -> dict:
    """Statistics of the last finished render; {} before the first."""
    return render_statistics.for_use("render")


@persistent
def stop(*_args: Any) -> None:
    """End all jobs and the render thread: before another file is loaded, and at exit."""
    persistent_data.forget()
    shared.stop()


def is_rendering() -> bool:
    """Whether a render is running in any thread. Blender would crash if the engine were unregistered now."""
    return bool(_rendering)


def register() -> None:
    bpy.utils.register_class(ISMRenderEngine)
    persistent_data.register()
    bpy.app.handlers.load_pre.append(stop)


def unregister() -> None:
    app_handlers.remove(bpy.app.handlers.load_pre, stop)
    redraw_timer.stop_timer()
    bpy.utils.unregister_class(ISMRenderEngine)
    persistent_data.unregister()
    stop()
