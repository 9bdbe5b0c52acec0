# SPDX-License-Identifier: GPL-3.0-or-later
"""Emission that the camera sees: of surfaces, and of lights."""
