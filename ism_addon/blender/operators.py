# SPDX-License-Identifier: GPL-3.0-or-later
# ruff: noqa: N801 (Blender's rule for the names of operators)
"""What the writer of a bug report and the developer who reads it want: a picture's origin as a file, shaders anew."""

import bpy
from bpy_extras.io_utils import ExportHelper

from .. import snapshot
from ..gpu.worker import shared
from ..scene import Scene, View
from ..settings import Settings
from . import camera, controls, extract, lookout, viewport


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
        depsgraph = context.evaluated_depsgraph_get()
        try:
            scene, view, chosen = _seen(context, depsgraph)
            snapshot.save(self.filepath, scene, view, chosen)
        except (camera.CameraError, OSError) as reason:
            self.report({"ERROR"}, f"The snapshot was not saved: {reason}")
            return {"CANCELLED"}
        size = f"{view.width}×{view.height} pixels, {scene.triangle_count:,} triangles"
        self.report({"INFO"}, f"Saved {size} to {self.filepath}")
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
        lookout.redraw()
        self.report({"INFO"}, "The next picture is drawn by the shaders as they are now")
        return {"FINISHED"}


def _seen(context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> tuple[Scene, View, Settings]:
    """What the viewport that asks is drawn from; from other editors, the final render."""
    if context.area is None or context.area.type != "VIEW_3D":
        return extract.scene(depsgraph), camera.final_view(depsgraph), controls.read(context.scene, "render")
    region = context.region
    if region.type != "WINDOW":  # of a quad view's four, the last can be turned
        region = [each for each in context.area.regions if each.type == "WINDOW"][-1]
    with context.temp_override(region=region):
        view, _place = viewport.seen(context, depsgraph)
    scene = extract.scene(depsgraph, viewport.shown_by(context.space_data))
    return scene, view, controls.read(context.scene, "viewport")


register, unregister = bpy.utils.register_classes_factory((ISM_OT_save_snapshot, ISM_OT_reload_shaders))
