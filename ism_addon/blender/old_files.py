# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts scenes saved by version 0.1.0: values, keyframes and drivers of renamed settings get the new names."""

from collections.abc import Iterator
from typing import Any

import bpy
from bpy.app.handlers import persistent

from .. import old_names
from ..settings import DebugView
from . import app_handlers

#: Property groups of `scene.ism` by section of the settings.
GROUPS = {"": ("",), "quality": ("render", "viewport")}


@persistent
def convert(*_file: Any) -> None:
    """Convert all scenes of the file that has been loaded."""
    for scene in bpy.data.scenes:
        stored = stored_properties(scene).get("ism")
        if stored is None:
            continue
        curves = list(curves_of(scene.animation_data))
        for section, groups in GROUPS.items():
            for group in groups:
                values = stored.get(group) if group else stored
                for old, new in old_names.SETTINGS[section].items():
                    if values is not None and old in values:
                        if new == "debug_view":
                            values[old] = current_debug_view(values[old])
                        move(values, old, new)
                    path = ".".join(filter(None, ("ism", group)))
                    for curve in curves:
                        if curve.data_path == f"{path}.{old}":
                            curve.data_path = f"{path}.{new}"


def current_debug_view(view: int) -> int:
    """The current index of a debug view, by its index in 0.1.0."""
    names = list(old_names.DEBUG_VIEWS.values())
    return list(DebugView).index(DebugView(names[view])) if 0 <= view < len(names) else 0  # type: ignore[call-arg]


def move(values: Any, old: str, new: str) -> None:
    """Move a stored value to another name, unless that already has one."""
    if new not in values:
        values[new] = values[old]
    del values[old]


def stored_properties(scene: bpy.types.Scene) -> Any:
    """The stored add-on properties of a scene, registered or not, like a dictionary."""
    if hasattr(scene, "bl_system_properties_get"):  # Blender 5.0
        return scene.bl_system_properties_get() or {}
    return scene


def curves_of(animation: bpy.types.AnimData | None) -> Iterator[bpy.types.FCurve]:
    """A scene's drivers, and the F-curves of its action."""
    if animation is None:
        return
    yield from animation.drivers
    if action := animation.action:
        if hasattr(action, "fcurves"):  # before Blender 5.0; of a layered action, those of its first slot
            yield from action.fcurves
        else:
            for layer in action.layers:
                for strip in layer.strips:
                    for bag in strip.channelbags:
                        yield from bag.fcurves


def register() -> None:
    bpy.app.handlers.load_post.append(convert)


def unregister() -> None:
    app_handlers.remove(bpy.app.handlers.load_post, convert)
