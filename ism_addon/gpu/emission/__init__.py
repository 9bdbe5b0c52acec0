# SPDX-License-Identifier: GPL-3.0-or-later
"""Emissive meshes as lights."""
