# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side: reads its data, runs the engine, shows the image."""
