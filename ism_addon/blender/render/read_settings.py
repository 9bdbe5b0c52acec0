# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user has turned: the properties under `scene.ism` as Settings."""

from typing import Any

import bpy

from ... import settings


def _section(cls: type, group: bpy.types.PropertyGroup) -> Any:
    values = {}
    for member, _control in settings.setting_fields(cls):
        kind: type = type(member.default)
        values[member.name] = kind(getattr(group, member.name))  # a choice is a string in Blender
    return cls(**values)


def read(scene: bpy.types.Scene, use: str) -> settings.Settings:
    """The settings for a use, "render" or "viewport": one look, two qualities."""
    group = scene.ism
    debug_view = settings.Settings.debug_view
    if use == "viewport":
        debug_view = settings.DebugView(group.debug_view)  # type: ignore[call-arg] # looks up, and makes none
    return settings.Settings(
        shadow=_section(settings.Shadow, group.shadow),
        ssao=_section(settings.SSAO, group.ssao),
        quality=_section(settings.Quality, getattr(group, use)),
        debug_view=debug_view,
    )


def pixel_size(scene: bpy.types.Scene) -> int:
    """How many of a viewport's pixels lie along either side of one that is drawn."""
    return 100 // int(scene.ism.viewport.resolution)
