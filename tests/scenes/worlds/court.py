# SPDX-License-Identifier: GPL-3.0-or-later
"""The demo's atrium under a clear sky with its sun, by Blender's Sky Texture."""

import math
from pathlib import Path

import bpy

from tests.scenes import atrium, blend_file
from tests.scenes.parts.node_tree import world_of

#: Elevation and rotation of the sun, rad.
SUNS = ((math.radians(48.0), math.radians(25.0)), (math.radians(35.0), math.radians(160.0)))
OTHER_CAMERA = (10.6, 1.6, 2.1), (-2.0, -0.4, 2.6), 22.0
#: A model of Blender 4.2 to 4.5, and the same in 5.0.
MODELS = "NISHITA", "SINGLE_SCATTERING"


def build(path: Path, variant: int = 0) -> None:
    """Build the scene and save it as a .blend. It replaces the open file."""
    atrium.build(path)
    for old in [each for each in bpy.data.objects if each.type == "LIGHT" or (variant and each.type == "CAMERA")]:
        bpy.data.objects.remove(old)
    if variant:
        blend_file.add_camera(*OTHER_CAMERA)
    elevation, rotation = SUNS[variant]
    models = [each.identifier for each in bpy.types.ShaderNodeTexSky.bl_rna.properties["sky_type"].enum_items]
    model = next(each for each in MODELS if each in models)

    def shader(tree):
        sky = tree.add("ShaderNodeTexSky", sky_type=model, sun_elevation=elevation, sun_rotation=rotation)
        return tree.add("ShaderNodeBackground", {"Color": sky, "Strength": 0.1})

    bpy.context.scene.world = world_of(shader)
    blend_file.save(path)
