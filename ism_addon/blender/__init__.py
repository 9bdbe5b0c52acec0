# SPDX-License-Identifier: GPL-3.0-or-later
"""The part that uses Blender: reads its data, runs the render engine, shows the image."""
