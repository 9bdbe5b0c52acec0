# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings about missing linked data."""

import bpy

from .diagnostics import Diagnostics


def warn_of_missing(depsgraph: bpy.types.Depsgraph, findings: Diagnostics) -> None:
    """Warn about all data that Blender has replaced by empty placeholders."""
    if len(bpy.data.libraries):
        for each in depsgraph.ids:
            if each.original.is_missing:
                findings.warn("Linked data that was not found is missing from the picture", each.name)
