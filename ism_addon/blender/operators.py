# SPDX-License-Identifier: GPL-3.0-or-later
# ruff: noqa: N801 (Blender's rule for the names of operators)
"""Operators for debugging: save a snapshot, reload the shaders."""

import bpy
from bpy_extras.io_utils import ExportHelper

from ..gpu.jobs.render_thread import shared
from .viewport import redraw_timer


class ISM_OT_save_snapshot(ExportHelper, bpy.types.Operator):
    """Scene, view and settings to one file, from which the render can be repeated without Blender."""

    bl_idname = "ism.save_snapshot"
    bl_label = "Save Snapshot"
    bl_description = (
        "Save scene, view and settings to one file, to render it elsewhere or to send it with a report: "
        "those of this viewport or, in other editors, those of the final render. Renders nothing"
    )
    filename_ext = ".npz"
    filter_glob: bpy.props.StringProperty(default="*.npz", options={"HIDDEN"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.engine == "ISM"

    def execute(self, context: bpy.types.Context) -> set[str]:
        from .render import save_snapshot  # imported late: Blender starts faster
        from .sync import camera

        try:
            saved = save_snapshot.save(context, self.filepath)
        except (camera.CameraError, OSError) as reason:
            why = f"{reason.strerror}: {self.filepath}" if isinstance(reason, OSError) else reason
            self.report({"ERROR"}, f"The snapshot was not saved: {why}")
            return {"CANCELLED"}
        self.report({"INFO"}, f"Saved {saved} to {self.filepath}")
        return {"FINISHED"}


class ISM_OT_reload_shaders(bpy.types.Operator):
    """Compile the shaders again, from their files as they are now."""

    bl_idname = "ism.reload_shaders"
    bl_label = "Reload Shaders"
    bl_description = (
        "Read the shaders' files again and redraw the viewports. "
        "An error in a shader is shown in the viewport's header, and the viewport keeps what it shows"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.engine == "ISM"

    def execute(self, context: bpy.types.Context) -> set[str]:
        shared.reload()
        redraw_timer.redraw()
        self.report({"INFO"}, "Shaders are compiled again")
        return {"FINISHED"}


register, unregister = bpy.utils.register_classes_factory((ISM_OT_save_snapshot, ISM_OT_reload_shaders))
