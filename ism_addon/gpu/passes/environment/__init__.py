# SPDX-License-Identifier: GPL-3.0-or-later
"""The world: its map, and what the camera sees of it."""
