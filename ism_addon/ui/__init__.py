# SPDX-License-Identifier: GPL-3.0-or-later
"""The user interface in Blender's editors. It uses `settings` and bpy, nothing of the method."""
