# SPDX-License-Identifier: GPL-3.0-or-later
"""What a picture is made of, as a file."""

import bpy

from ... import snapshot
from ...scene import Scene, View
from ...settings import Settings
from ..sync import camera, scene_reader
from ..viewport import viewport
from . import read_settings


def save(context: bpy.types.Context, path: str) -> str:
    """Save it, and say how much it is. Raises CameraError and OSError."""
    scene, view, chosen = seen(context, context.evaluated_depsgraph_get())
    snapshot.save(path, scene, view, chosen)
    return f"{view.width}×{view.height} pixels, {scene.triangle_count:,} triangles"


def seen(context: bpy.types.Context, depsgraph: bpy.types.Depsgraph) -> tuple[Scene, View, Settings]:
    """What the viewport that asks is drawn from; from other editors, the final render."""
    if context.area is None or context.area.type != "VIEW_3D":
        return scene_reader.scene(depsgraph), camera.final_view(depsgraph), read_settings.read(context.scene, "render")
    region = context.region
    if region.type != "WINDOW":  # of a quad view's four, the last can be turned
        region = [each for each in context.area.regions if each.type == "WINDOW"][-1]
    with context.temp_override(region=region):
        view, _place = viewport.seen(context, depsgraph)
    scene = scene_reader.scene(depsgraph, viewport.shown_by(context.space_data))
    return scene, view, read_settings.read(context.scene, "viewport")
