# SPDX-License-Identifier: GPL-3.0-or-later
"""An extra darkening of creases in the light of the world and of all lights, exact by rays."""

import bpy

ssao = bpy.context.scene.ism.ssao
ssao.sampling = "TRACED"
ssao.light = "ALL"
ssao.radius = 0.3
