# SPDX-License-Identifier: GPL-3.0-or-later
"""The demo's atrium with a black world; as variant 1, with other lights and another camera too."""

from pathlib import Path

import bpy

from . import atrium, blend_file
from .blend_file import COOL, WARM, AreaLight

OTHER_LIGHTS = (
    AreaLight("SQUARE", (5.0, -3.8, 16.0), (-2.0, 1.2, 0.0), 5000.0, (0.9, 0.9), (1.0, 0.9, 0.76)),
    AreaLight("ELLIPSE", (-1.0, -0.4, 10.4), (-0.5, 0.2, 0.0), 420.0, (16.0, 4.4), COOL),
    AreaLight("DISK", (-4.5, 5.7, 3.5), (-4.6, 5.4, 0.0), 55.0, (0.3, 0.3), WARM),
    AreaLight("RECTANGLE", (1.5, -5.7, 3.5), (1.4, -5.4, 0.0), 60.0, (0.7, 0.15), WARM),
    AreaLight("SQUARE", (-13.6, 0.5, 3.5), (-13.4, 0.4, 0.0), 55.0, (0.4, 0.4), WARM),
)
OTHER_CAMERA = (10.6, 1.6, 2.1), (-2.0, -0.4, 2.6), 22.0


def build(path: Path, variant: int = 0) -> None:
    """Build the scene and save it as a .blend. It replaces the open file."""
    atrium.build(path)
    blend_file.set_black_world()
    if variant:
        for old in [each for each in bpy.data.objects if each.type in {"LIGHT", "CAMERA"}]:
            bpy.data.objects.remove(old)
        blend_file.add_lights(OTHER_LIGHTS)
        blend_file.add_camera(*OTHER_CAMERA)
    blend_file.save(path)
