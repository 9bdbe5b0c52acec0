# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes that a world of a map or a sky lights."""
