# SPDX-License-Identifier: GPL-3.0-or-later
"""As in the report of 2013: points on the screen, blurred."""

import bpy

bpy.context.scene.ism.ssao.sampling = "POINTS"
