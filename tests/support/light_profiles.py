# SPDX-License-Identifier: GPL-3.0-or-later
"""A light profile for tests."""

import numpy as np

from ism_addon.scene import LightProfile


def beam() -> LightProfile:
    """A downlight, wider along one axis, brighter on one side, and dark above."""
    azimuth, polar = np.linspace(0.0, 2.0 * np.pi, 145)[:, None], np.linspace(0.0, np.pi, 361)
    width = 0.5 + 0.2 * np.cos(2.0 * azimuth)
    factors = np.exp(-((polar / width) ** 2)) * (1.0 + 0.4 * np.sin(polar) * np.sin(azimuth)) + 0.02 * np.cos(polar / 2)
    return LightProfile((factors / factors.max()).astype(np.float32))
