# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's node Sky Texture: the colours that Cycles renders for it, and the disc of its sun."""

from .parameters import Sky, SkyModel

__all__ = ["Sky", "SkyModel"]
