# SPDX-License-Identifier: GPL-3.0-or-later
# ruff: noqa: N801 (Blender's rule for the names of panels)
"""The most used settings, in the popover of the 3D viewport's shading."""

import bpy

from ..choices import Method
from .panels import ISM_RENDER_PT_ssao


class ISM_VIEW3D_PT_shading(bpy.types.Panel):
    bl_label = "ISM"
    bl_space_type = "VIEW_3D"
    bl_region_type = "HEADER"
    bl_parent_id = "VIEW3D_PT_shading"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.engine == "ISM" and context.space_data.shading.type == "RENDERED"

    def draw(self, context: bpy.types.Context) -> None:
        ism, layout = context.scene.ism, self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(ism.shadow, "enabled")
        layout.prop(ism.shadow, "world" if ism.shadow.method == Method.RAY_TRACED else "sky_dome")
        occlusion = layout.column()
        occlusion.active = ISM_RENDER_PT_ssao.is_used(context.scene)
        occlusion.prop(ism.ssao, "enabled")
        details = occlusion.column()
        details.active = ism.ssao.enabled
        details.prop(ism.ssao, "radius")
        details.prop(ism.ssao, "intensity")
        quality = layout.column()
        quality.prop(ism.viewport, "samples")
        quality.prop(ism.viewport, "resolution")
        layout.prop(ism, "debug_view")


register, unregister = bpy.utils.register_classes_factory((ISM_VIEW3D_PT_shading,))
