# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads Blender's evaluated scene into arrays, with warnings about what this engine does not draw."""
