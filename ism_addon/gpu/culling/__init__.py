# SPDX-License-Identifier: GPL-3.0-or-later
"""Culling of instances and meshes outside the view, of occluders, and of lights."""
