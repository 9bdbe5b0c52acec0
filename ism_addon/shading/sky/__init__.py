# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's node Sky Texture: the colours that Cycles renders for it, and the disc of its sun."""

from .colors import radiance, sky_image
from .parameters import Sky, SkyModel
from .sun_disc import Sun, sun, sun_irradiance, sun_radiance

__all__ = ["Sky", "SkyModel", "Sun", "radiance", "sky_image", "sun", "sun_irradiance", "sun_radiance"]
