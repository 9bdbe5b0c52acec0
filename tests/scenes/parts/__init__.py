# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes, materials and textures that the scenes are built from."""
