# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user sees in Blender's editors: knows `settings` and bpy, nothing of the method."""
