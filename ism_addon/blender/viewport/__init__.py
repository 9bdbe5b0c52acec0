# SPDX-License-Identifier: GPL-3.0-or-later
"""Rendering in the 3D viewport."""
