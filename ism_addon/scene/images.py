# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of materials."""

from dataclasses import dataclass

import numpy as np

from .arrays import Arrays, array


@dataclass(frozen=True, eq=False)
class Image(Arrays):
    """Texels, sRGB-encoded, bottom row first."""

    texels: np.ndarray = array("uint8 H W 4")
    repeat: bool = True  # else texture coordinates are clamped
