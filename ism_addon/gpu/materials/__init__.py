# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaders of materials: the GLSL of node graphs."""
