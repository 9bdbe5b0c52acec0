# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes, instances and materials in buffers that shaders read."""
