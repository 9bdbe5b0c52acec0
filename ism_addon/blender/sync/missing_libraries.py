# SPDX-License-Identifier: GPL-3.0-or-later
"""What is linked from other files, and is not there."""

import bpy

from .diagnostics import Diagnostics


def note_missing(depsgraph: bpy.types.Depsgraph, findings: Diagnostics) -> None:
    """Note all for which Blender has put something empty in place, without a word to who looks at the picture."""
    if len(bpy.data.libraries):
        for each in depsgraph.ids:
            if each.original.is_missing:
                findings.note("Linked data that was not found is missing from the picture", each.name)
