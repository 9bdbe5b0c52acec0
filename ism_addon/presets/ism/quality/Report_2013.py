# SPDX-License-Identifier: GPL-3.0-or-later
"""As in the report of 2013: one sample by imperfect shadow maps and occlusion by points, in the viewport as large."""

import bpy

ism = bpy.context.scene.ism
ism.shadow.method = "SHADOW_MAPS"
ism.shadow.sky_dome = False
ism.ssao.sampling = "POINTS"
ism.render.samples = 1
for name in ("samples", "virtual_lights", "map_size", "map_points"):
    setattr(ism.viewport, name, getattr(ism.render, name))
