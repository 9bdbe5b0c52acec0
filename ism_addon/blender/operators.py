# SPDX-License-Identifier: GPL-3.0-or-later
# ruff: noqa: N801 (Blender's rule for the names of operators)
"""What the writer of a bug report and the developer who reads it want: a picture's origin as a file, shaders anew."""

import bpy
from bpy_extras.io_utils import ExportHelper

from ..gpu.jobs.render_thread import shared
from .viewport import redraw_timer


class ISM_OT_save_snapshot(ExportHelper, bpy.types.Operator):
    """Scene, view and settings to one file, from which the picture can be drawn without Blender."""

    bl_idname = "ism.save_snapshot"
    bl_label = "Save Snapshot"
    bl_description = (
        "Save all that the picture is made of, to be drawn elsewhere or sent with a report: "
        "what this viewport shows or, from other editors, what the scene's camera sees. Takes no time for drawing"
    )
    filename_ext = ".npz"
    filter_glob: bpy.props.StringProperty(default="*.npz", options={"HIDDEN"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.engine == "ISM"

    def execute(self, context: bpy.types.Context) -> set[str]:
        from .render import save_snapshot  # Blender starts without what reads scenes
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
    """What is drawn from now on is drawn by the shaders as they are now."""

    bl_idname = "ism.reload_shaders"
    bl_label = "Reload Shaders"
    bl_description = (
        "Read the shaders' files again and draw the viewports anew, which takes the time of a first picture. "
        "A mistake in a shader is told in the viewport, which keeps its picture"
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.engine == "ISM"

    def execute(self, context: bpy.types.Context) -> set[str]:
        shared.reload()
        redraw_timer.redraw()
        self.report({"INFO"}, "The next picture is drawn by the shaders as they are now")
        return {"FINISHED"}


register, unregister = bpy.utils.register_classes_factory((ISM_OT_save_snapshot, ISM_OT_reload_shaders))
