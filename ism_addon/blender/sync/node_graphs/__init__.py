# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads Blender's shader nodes into graphs."""
