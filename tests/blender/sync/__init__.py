# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading Blender's scene."""
