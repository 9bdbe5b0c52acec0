# SPDX-License-Identifier: GPL-3.0-or-later
"""Dark where surfaces meet: a radius of a few centimeters."""

import bpy

ssao = bpy.context.scene.ism.ssao
ssao.radius = 0.1
ssao.intensity = 1.5
