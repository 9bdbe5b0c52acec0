# SPDX-License-Identifier: GPL-3.0-or-later
"""The render engine, as Blender calls it. `final` and `viewport` do what it is asked for.

They are imported when they are first asked: Blender starts without them, and most files are for other engines.
"""

from importlib.machinery import ExtensionFileLoader
from typing import TYPE_CHECKING, Any

import bpy
from bpy.app.handlers import persistent

from ..gpu.jobs.render_thread import shared
from ..render_passes import asked_for
from . import app_handlers
from .render import persistent_data, render_statistics
from .viewport import redraw_timer

if TYPE_CHECKING:
    from .viewport.viewport import Viewport

__all__ = ["IS_BPY_MODULE", "ISMRenderEngine", "is_rendering", "register", "statistics", "stop", "unregister"]

#: Python has imported Blender, rather than Blender Python.
IS_BPY_MODULE = isinstance(bpy.__spec__.loader, ExtensionFileLoader)


#: One for each render that Blender is in: a handler may begin another.
_rendering: list[str] = []


class ISMRenderEngine(bpy.types.RenderEngine):
    """Ray traced soft shadows of area lights, and screen-space ambient occlusion."""

    bl_idname = "ISM"
    bl_label = "ISM"
    bl_use_preview = True
    bl_use_eevee_viewport = True  # for Material Preview, which is empty otherwise
    bl_use_shading_nodes_custom = False  # else Blender hides its own material nodes

    _viewport: Any = None  # a Viewport, which Blender would look for at once if it were named here

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)

    def update_render_passes(self, scene: bpy.types.Scene, renderlayer: bpy.types.ViewLayer) -> None:
        for each in asked_for(renderlayer):
            self.register_pass(scene, renderlayer, each.name, len(each.channels), each.channels, each.kind)

    def render(self, depsgraph: bpy.types.Depsgraph) -> None:
        from .render import final_render

        _rendering.append(self.bl_idname)
        try:
            final_render.render(self, depsgraph)
        except KeyboardInterrupt:  # of the bpy module; Blender itself takes Ctrl+C for Escape
            self.report({"ERROR"}, "The render was interrupted")
        except Exception as error:
            self.report({"ERROR"}, f"The picture could not be made: {error}")
            raise
        finally:
            _rendering.pop()

    def view_update(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        self._own_viewport().update(context, depsgraph)
        self.tag_redraw()  # a script's edit need not have told any editor

    def view_draw(self, context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> None:
        self._own_viewport().draw(self, context, depsgraph)

    @staticmethod
    def latest_statistics() -> tuple[str, dict]:
        """For the panels, which ask the engine by its name."""
        return render_statistics.latest()

    def _own_viewport(self) -> "Viewport":
        if self._viewport is None:
            from .viewport.viewport import Viewport

            self._viewport = Viewport()
        return self._viewport


def statistics() -> dict:
    """What the last finished render drew, reused and skipped, and what each pass took; {} before the first."""
    return render_statistics.for_use("render")


@persistent
def stop(*_args: Any) -> None:
    """End all drawing, and the worker's thread: before another file is loaded, and at the end."""
    persistent_data.forget()
    shared.stop()


def is_rendering() -> bool:
    """Whether Blender is in a render of ours, in any thread: it would crash if the engine were unregistered now."""
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
