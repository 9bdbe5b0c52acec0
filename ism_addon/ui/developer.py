# SPDX-License-Identifier: GPL-3.0-or-later
# ruff: noqa: N801 (Blender's rule for the names of panels)
"""The panel for debugging: debug views, snapshots, shaders."""

import bpy

from .panels import ISMPanel


class ISM_RENDER_PT_developer(ISMPanel, bpy.types.Panel):
    bl_label = "Developer"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.prop(context.scene.ism, "debug_view")
        layout.operator("ism.save_snapshot", icon="FILE_TICK")
        layout.operator("ism.reload_shaders", icon="FILE_REFRESH")


register, unregister = bpy.utils.register_classes_factory((ISM_RENDER_PT_developer,))
