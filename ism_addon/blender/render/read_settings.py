# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the properties under `scene.ism` as Settings."""

from typing import Any

import bpy

from ... import settings
from ...settings.setting_fields import setting_fields


def _section(cls: type, group: bpy.types.PropertyGroup) -> Any:
    values = {}
    for member, _control in setting_fields(cls):
        type_: type = type(member.default)
        values[member.name] = type_(getattr(group, member.name))  # a choice is a string in Blender, a color an array
    return cls(**values)


def read(scene: bpy.types.Scene, use: str) -> settings.Settings:
    """The settings for a use, "render" or "viewport"."""
    group = scene.ism
    debug_view = settings.Settings.debug_view
    if use == "viewport":
        debug_view = settings.DebugView(group.debug_view)  # type: ignore[call-arg] # a lookup
    return settings.Settings(
        shadow=_section(settings.Shadow, group.shadow),
        ssao=_section(settings.SSAO, group.ssao),
        quality=_section(settings.Quality, getattr(group, use)),
        debug_view=debug_view,
    )


def pixel_size(scene: bpy.types.Scene) -> int:
    """Width of a rendered pixel in pixels of the viewport."""
    return 100 // int(scene.ism.viewport.resolution)
