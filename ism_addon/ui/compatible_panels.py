# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own panels that serve this engine too: it is added to their COMPAT_ENGINES, and taken out again."""

from collections.abc import Iterator

import bpy

#: Made for Blender's engines by name, but right here too.
ALSO = {
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_surface",
    "MATERIAL_PT_preview",
}
#: Open to every engine, but about what this one does not draw, or has a panel of its own for.
LEFT_OUT = {
    "DATA_PT_light",
    "DATA_PT_spot",
    "DATA_PT_volume_render",
    "MATERIAL_PT_freestyle_line",
    "NODE_DATA_PT_light",
    "OBJECT_PT_shading",
    "RENDER_PT_freestyle",
}
LEFT_OUT_PREFIXES = ("DATA_PT_lightprobe", "VIEWLAYER_PT_freestyle")


def panels() -> Iterator[type[bpy.types.Panel]]:
    """Every panel to borrow, in this version of Blender and with the add-ons that are enabled."""
    for panel in bpy.types.Panel.__subclasses__():
        name = panel.__name__
        if name in LEFT_OUT or name.startswith(LEFT_OUT_PREFIXES):
            continue
        if name in ALSO or "BLENDER_RENDER" in getattr(panel, "COMPAT_ENGINES", ()):
            yield panel


def register() -> None:
    for panel in panels():
        panel.COMPAT_ENGINES.add("ISM")


def unregister() -> None:
    for panel in panels():
        panel.COMPAT_ENGINES.discard("ISM")
