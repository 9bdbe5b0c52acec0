# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures with the limits that OpenGL 4.1 guarantees, and by a second OpenGL implementation."""
