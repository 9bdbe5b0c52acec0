# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenGL without a window: the context, and buffers, textures, targets, shaders and draws in it."""
