# SPDX-License-Identifier: GPL-3.0-or-later
# ruff: noqa: N801 (Blender's rule for the names of panels and operators)
"""Presets of quality and of ambient occlusion: scripts, as in Blender. Ours are in the package.

Those of users are in Blender's folder. Before a preset is run, all properties that its kind sets are reset.
So ours only set what differs from the defaults.
"""

from pathlib import Path
from typing import Any

import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel

from .. import old_names, settings
from ..atomic_files import atomic_write
from ..settings.setting_fields import setting_fields
from . import redraw

#: Contains the folder `presets`, where Blender looks for preset_subdir.
FOLDER = str(Path(__file__).parents[1])

#: Properties under scene.ism that a preset of quality sets: (group, name). Quality and methods, but not the look of
#: shadows and occlusion.
PRESET_PROPERTIES = [
    ("shadow", "method"),
    ("ssao", "sampling"),
    *(("render", member.name) for member, _ in setting_fields(type(settings.FINAL))),
    *(("viewport", member.name) for member, _ in setting_fields(type(settings.VIEWPORT))),
]


#: Those of the presets of ambient occlusion.
OCCLUSION_PROPERTIES = [
    ("ssao", member.name) for member, _ in setting_fields(settings.SSAO) if member.name != "enabled"
]


class SettingPresets(PresetPanel):
    """Presets of some properties under scene.ism."""

    preset_operator = "script.execute_preset"
    properties: list[tuple[str, str]]

    @classmethod
    def reset_cb(cls, context: bpy.types.Context, path: str) -> None:
        """Before a preset's script is run: reset the properties, and rewrite a script of 0.1.0 with current names."""
        with open(path, encoding="utf-8") as file:
            script = file.read()
        if (current := old_names.current_preset(script)) != script:
            with atomic_write(path) as file:
                file.write(current.encode())
        for group, name in cls.properties:
            getattr(context.scene.ism, group).property_unset(name)

    @staticmethod
    def post_cb(context: bpy.types.Context, path: str) -> None:
        """After a preset's script: push an undo step, which Blender's operator does not."""
        redraw.viewports(None, context)
        bpy.ops.ed.undo_push(message=f"Preset {bpy.path.display_name_from_filepath(path)}")


class ISM_RENDER_PT_presets(SettingPresets, bpy.types.Panel):
    bl_label = "Quality Presets"
    preset_subdir = "ism/quality"
    preset_add_operator = "render.ism_preset_add"
    properties = PRESET_PROPERTIES


class ISM_RENDER_PT_occlusion_presets(SettingPresets, bpy.types.Panel):
    bl_label = "Ambient Occlusion Presets"
    preset_subdir = "ism/occlusion"
    preset_add_operator = "render.ism_occlusion_preset_add"
    properties = OCCLUSION_PROPERTIES


class RENDER_OT_ism_preset_add(AddPresetBase, bpy.types.Operator):
    """Save the quality of the viewport and of final renders as a preset, or remove one"""

    bl_idname = "render.ism_preset_add"
    bl_label = "Add Quality Preset"
    preset_menu = "ISM_RENDER_PT_presets"
    preset_subdir = ISM_RENDER_PT_presets.preset_subdir
    preset_defines = ["ism = bpy.context.scene.ism"]
    preset_values = [f"ism.{group}.{name}" for group, name in PRESET_PROPERTIES]


class RENDER_OT_ism_occlusion_preset_add(AddPresetBase, bpy.types.Operator):
    """Save the look of ambient occlusion as a preset, or remove one"""

    bl_idname = "render.ism_occlusion_preset_add"
    bl_label = "Add Ambient Occlusion Preset"
    preset_menu = "ISM_RENDER_PT_occlusion_presets"
    preset_subdir = ISM_RENDER_PT_occlusion_presets.preset_subdir
    preset_defines = ["ism = bpy.context.scene.ism"]
    preset_values = [f"ism.{group}.{name}" for group, name in OCCLUSION_PROPERTIES]


CLASSES: tuple[Any, ...] = (
    *(ISM_RENDER_PT_presets, RENDER_OT_ism_preset_add),
    *(ISM_RENDER_PT_occlusion_presets, RENDER_OT_ism_occlusion_preset_add),
)


def register() -> None:
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.utils.register_preset_path(FOLDER)


def unregister() -> None:
    bpy.utils.unregister_preset_path(FOLDER)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
