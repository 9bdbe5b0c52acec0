# SPDX-License-Identifier: GPL-3.0-or-later
"""Soft and wide, by rays: what the camera does not see darkens too."""

import bpy

ssao = bpy.context.scene.ism.ssao
ssao.sampling = "TRACED"
ssao.radius = 3.0
