# SPDX-License-Identifier: GPL-3.0-or-later
"""Seconds until a large map of all directions lights a scene."""
