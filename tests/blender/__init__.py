# SPDX-License-Identifier: GPL-3.0-or-later
"""In Blender: what is read of a scene, what is rendered, what the user is shown."""
