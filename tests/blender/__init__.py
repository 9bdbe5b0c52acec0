# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests in Blender: reading scenes, rendering, and the user interface."""
