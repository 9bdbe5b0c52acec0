# SPDX-License-Identifier: GPL-3.0-or-later
"""What is read of Blender's scene."""
