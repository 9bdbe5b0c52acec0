# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the world: what lights surfaces, and what the camera sees of it."""
