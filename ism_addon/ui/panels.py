# SPDX-License-Identifier: GPL-3.0-or-later
# ruff: noqa: N801 (Blender's rule for the names of panels)
"""The engine's own panels. Those for settings loop over a section's fields, so a new setting needs no code here."""

import bpy

from .. import render_passes, settings
from ..choices import Method, OccludedLight, OcclusionSampling, RadiusUnit
from ..settings.setting_fields import setting_fields
from .presets import ISM_RENDER_PT_occlusion_presets, ISM_RENDER_PT_presets


class ISMPanel:
    """A panel of the properties editor, visible while ISM is the render engine."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {"ISM"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.engine in cls.COMPAT_ENGINES


class SectionPanel(ISMPanel):
    """The settings of one section that the scene's method uses, greyed out while the switch they depend on is off."""

    layout: bpy.types.UILayout
    section: type
    name: str  # under scene.ism
    depends_on: dict[str, str] = {}  # setting: the switch

    def draw(self, context: bpy.types.Context) -> None:
        group = getattr(context.scene.ism, self.name)
        layout = self.layout
        layout.use_property_split = True
        layout.active = getattr(group, "enabled", True) and self.is_used(context.scene)
        for name in self.shown(context.scene):
            row = layout.row()
            row.active = getattr(group, self.depends_on.get(name, ""), True)
            row.prop(group, name)

    @classmethod
    def is_used(cls, scene: bpy.types.Scene) -> bool:
        """Whether the settings can change the render."""
        return True

    @classmethod
    def shown(cls, scene: bpy.types.Scene) -> list[str]:
        """Names of the settings that the panel shows in this scene, without its switch in the header."""
        return [
            member.name
            for member, control in setting_fields(cls.section)
            if member.name != "enabled" and control.method in (None, scene.ism.shadow.method)
        ]


class SwitchedPanel(SectionPanel):
    """A section that can be turned off in its header."""

    def draw_header(self, context: bpy.types.Context) -> None:
        self.layout.prop(getattr(context.scene.ism, self.name), "enabled", text="")


class ISM_RENDER_PT_sampling(ISMPanel, bpy.types.Panel):
    bl_label = "Sampling"

    def draw_header_preset(self, _context: bpy.types.Context) -> None:
        ISM_RENDER_PT_presets.draw_panel_header(self.layout)

    def draw(self, _context: bpy.types.Context) -> None:
        pass


class ISM_RENDER_PT_sampling_viewport(SectionPanel, bpy.types.Panel):
    bl_label = "Viewport"
    bl_parent_id = "ISM_RENDER_PT_sampling"
    section = settings.ViewportQuality
    name = "viewport"


class ISM_RENDER_PT_sampling_render(SectionPanel, bpy.types.Panel):
    bl_label = "Render"
    bl_parent_id = "ISM_RENDER_PT_sampling"
    section = settings.Quality
    name = "render"


class ISM_RENDER_PT_shadow(SwitchedPanel, bpy.types.Panel):
    bl_label = "Shadows"
    section = settings.Shadow
    name = "shadow"
    depends_on = {"fill_threshold": "fill_holes"}


class ISM_RENDER_PT_ssao(SwitchedPanel, bpy.types.Panel):
    bl_label = "Ambient Occlusion"
    section = settings.SSAO
    name = "ssao"

    def draw_header_preset(self, _context: bpy.types.Context) -> None:
        ISM_RENDER_PT_occlusion_presets.draw_panel_header(self.layout)

    @classmethod
    def is_used(cls, scene: bpy.types.Scene) -> bool:
        """Not where it darkens only a world without shadows, and it has shadows."""
        shadow = scene.ism.shadow
        world_shadows = shadow.world if shadow.method == Method.RAY_TRACED else shadow.sky_dome
        return not (shadow.enabled and world_shadows and scene.ism.ssao.light == OccludedLight.UNSHADOWED)

    @classmethod
    def shown(cls, scene: bpy.types.Scene) -> list[str]:
        """Without what the sampling and the unit do not use."""
        ssao = scene.ism.ssao
        unused = {"radius" if ssao.unit == RadiusUnit.PIXELS else "radius_pixels"}
        unused |= {"thickness"} - ({"thickness"} if ssao.sampling == OcclusionSampling.HORIZONS else set())
        return [name for name in super().shown(scene) if name not in unused]


class ISM_RENDER_PT_film(ISMPanel, bpy.types.Panel):
    bl_label = "Film"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.prop(context.scene.render, "filter_size")
        layout.prop(context.scene.render, "film_transparent", text="Transparent")


class ISM_VIEWLAYER_PT_passes(ISMPanel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column(heading="Include")
        for each in render_passes.RENDER_PASSES:
            if each.switch:
                column.prop(context.view_layer, each.switch, text=each.name)


class ISM_LIGHT_PT_light(ISMPanel, bpy.types.Panel):
    """Each of Blender's light panels is for one engine, and none has all properties that this engine draws."""

    bl_label = "Light"
    bl_context = "data"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.light is not None and super().poll(context)

    def draw(self, context: bpy.types.Context) -> None:
        light, layout = context.light, self.layout
        layout.row().prop(light, "type", expand=True)
        layout.use_property_split = True
        self._draw_power(light, layout.column())
        if light.type == "AREA":
            self._draw_shape(light, layout.column())
        elif light.type == "SUN":
            layout.prop(light, "angle")
        else:
            layout.prop(light, "shadow_soft_size", text="Radius")
            layout.prop(light, "use_soft_falloff")
        if light.type == "SPOT":
            layout.prop(light, "spot_size", text="Beam Angle")
            layout.prop(light, "spot_blend", text="Blend", slider=True)
            layout.prop(light, "show_cone")

    @staticmethod
    def _draw_power(light: bpy.types.Light, column: bpy.types.UILayout) -> None:
        if hasattr(light, "use_temperature"):  # from Blender 4.5 on, as exposure and normalize
            row = column.row(heading="Temperature")
            row.prop(light, "use_temperature", text="")
            temperature = row.row()
            temperature.active = light.use_temperature
            temperature.prop(light, "temperature", text="")
        column.prop(light, "color")
        column.prop(light, "energy", text="Strength" if light.type == "SUN" else "Power")
        if hasattr(light, "exposure"):
            column.prop(light, "exposure")
            column.prop(light, "normalize")

    @staticmethod
    def _draw_shape(light: bpy.types.AreaLight, column: bpy.types.UILayout) -> None:
        column.prop(light, "shape")
        if light.shape in {"RECTANGLE", "ELLIPSE"}:
            sizes = column.column(align=True)
            sizes.prop(light, "size", text="Size X")
            sizes.prop(light, "size_y", text="Y")
        else:
            column.prop(light, "size")
        column.prop(light, "spread")


class ISM_LIGHT_PT_shadow(ISMPanel, bpy.types.Panel):
    bl_label = "Shadow"
    bl_context = "data"
    bl_parent_id = "ISM_LIGHT_PT_light"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.light is not None and super().poll(context)

    def draw_header(self, context: bpy.types.Context) -> None:
        self.layout.prop(context.light, "use_shadow", text="")

    def draw(self, context: bpy.types.Context) -> None:
        light, layout = context.light, self.layout
        layout.use_property_split = True
        layout.active = light.use_shadow
        for name in ("shadow_softness", "shadow_color", "shadow_density"):
            layout.prop(light.ism, name)


class ISM_OBJECT_PT_ray_visibility(ISMPanel, bpy.types.Panel):
    bl_label = "Ray Visibility"
    bl_context = "object"
    bl_parent_id = "OBJECT_PT_visibility"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return super().poll(context) and context.object is not None and context.object.type not in {"LIGHT", "CAMERA"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.prop(context.object, "visible_camera", text="Camera")
        layout.prop(context.object, "visible_shadow", text="Shadow")


CLASSES = (
    ISM_RENDER_PT_sampling,
    ISM_RENDER_PT_sampling_viewport,
    ISM_RENDER_PT_sampling_render,
    ISM_RENDER_PT_shadow,
    ISM_RENDER_PT_ssao,
    ISM_RENDER_PT_film,
    ISM_VIEWLAYER_PT_passes,
    ISM_LIGHT_PT_light,
    ISM_LIGHT_PT_shadow,
    ISM_OBJECT_PT_ray_visibility,
)

register, unregister = bpy.utils.register_classes_factory(CLASSES)
