# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's node Sky Texture: the colours that Cycles renders for it, and the disc of its sun."""

from .colors import radiance, sky_image
from .parameters import Sky, SkyModel

__all__ = ["Sky", "SkyModel", "radiance", "sky_image"]
