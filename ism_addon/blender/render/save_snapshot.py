# SPDX-License-Identifier: GPL-3.0-or-later
"""Saves scene, view and settings as a snapshot file."""

import bpy

from ... import snapshot
from ...scene import Scene, View
from ...settings import Settings
from ..sync import camera, scene_reader
from ..viewport import viewport
from . import read_settings


def save(context: bpy.types.Context, path: str) -> str:
    """Save a snapshot, and return its size as text. Raises CameraError and OSError."""
    scene, view, settings = scene_and_view(context, context.evaluated_depsgraph_get())
    snapshot.save(path, scene, view, settings)
    return f"{view.width}×{view.height} pixels, {scene.triangle_count:,} triangles"


def scene_and_view(context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> tuple[Scene, View, Settings]:
    """Scene, view and settings of the context's viewport; in other editors, of the final render."""
    if context.area is None or context.area.type != "VIEW_3D":
        return scene_reader.scene(depsgraph), camera.final_view(depsgraph), read_settings.read(context.scene, "render")
    region = context.region
    if region.type != "WINDOW":  # in a quad view, the last one can be rotated
        region = [each for each in context.area.regions if each.type == "WINDOW"][-1]
    with context.temp_override(region=region):
        view, _rect = viewport.viewport_view(context, depsgraph)
    scene = scene_reader.scene(depsgraph, viewport.visibility_in(context.space_data))
    return scene, view, read_settings.read(context.scene, "viewport")
