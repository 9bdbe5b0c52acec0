# SPDX-License-Identifier: GPL-3.0-or-later
"""Adds this engine to COMPAT_ENGINES of Blender's own panels, and removes it again."""

from collections.abc import Iterator

import bpy

#: Panels for Blender's engines only that also suit this one.
INCLUDED = {
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_surface",
    "MATERIAL_PT_preview",
}
#: Panels for every engine about features that this one does not draw or has its own panel for.
EXCLUDED = {
    "DATA_PT_light",
    "DATA_PT_spot",
    "DATA_PT_volume_render",
    "MATERIAL_PT_freestyle_line",
    "NODE_DATA_PT_light",
    "OBJECT_PT_shading",
    "RENDER_PT_freestyle",
}
EXCLUDED_PREFIXES = ("DATA_PT_lightprobe", "VIEWLAYER_PT_freestyle")


def panels() -> Iterator[type[bpy.types.Panel]]:
    """Every compatible panel of this version of Blender and of the enabled add-ons."""
    for panel in bpy.types.Panel.__subclasses__():
        name = panel.__name__
        if name in EXCLUDED or name.startswith(EXCLUDED_PREFIXES):
            continue
        if name in INCLUDED or "BLENDER_RENDER" in getattr(panel, "COMPAT_ENGINES", ()):
            yield panel


def register() -> None:
    for panel in panels():
        panel.COMPAT_ENGINES.add("ISM")


def unregister() -> None:
    for panel in panels():
        panel.COMPAT_ENGINES.discard("ISM")
