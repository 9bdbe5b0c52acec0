# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of ambient occlusion, by how occluders are found."""
