# SPDX-License-Identifier: GPL-3.0-or-later
"""Whole pictures, without Blender."""
