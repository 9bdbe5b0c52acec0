# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's evaluated scene, read into arrays; and what of it this engine does not draw."""
