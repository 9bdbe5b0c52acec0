# SPDX-License-Identifier: GPL-3.0-or-later
"""A light profile and a light image for tests."""

import numpy as np

from ism_addon.scene import LightImage, LightProfile


def beam() -> LightProfile:
    """A downlight, wider along one axis, brighter on one side, and dark above."""
    azimuth, polar = np.linspace(0.0, 2.0 * np.pi, 145)[:, None], np.linspace(0.0, np.pi, 361)
    width = 0.5 + 0.2 * np.cos(2.0 * azimuth)
    factors = np.exp(-((polar / width) ** 2)) * (1.0 + 0.4 * np.sin(polar) * np.sin(azimuth)) + 0.02 * np.cos(polar / 2)
    return LightProfile((factors / factors.max()).astype(np.float32))


def stripes() -> LightImage:
    """Colored stripes along a gradient, of another pattern along each side."""
    v, u = np.meshgrid(np.linspace(0.0, 1.0, 24), np.linspace(0.0, 1.0, 32), indexing="ij")
    colors = np.stack([0.2 + 0.8 * u, 0.5 + 0.5 * np.sin(12.0 * v), 0.9 - 0.8 * u * v], -1)
    return LightImage((colors / colors.max()).astype(np.float32))
