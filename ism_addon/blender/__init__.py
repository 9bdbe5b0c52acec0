# SPDX-License-Identifier: GPL-3.0-or-later
"""All that knows Blender's data: reads it, runs the engine, shows the image."""
