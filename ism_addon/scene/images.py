# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of materials."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from .arrays import Arrays, array


class Encoding(StrEnum):
    """How the texels of an image store its values. Alpha is always linear."""

    SRGB = "SRGB"  # 8 bits, with sRGB's transfer function
    LINEAR = "LINEAR"  # 8 bits, linear: 255 is 1
    FLOAT = "FLOAT"  # 16-bit floats, linear, without a limit

    @property
    def dtype(self) -> np.dtype:
        """Dtype of the texels."""
        return np.dtype(np.float16 if self is Encoding.FLOAT else np.uint8)


@dataclass(frozen=True, eq=False)
class Image(Arrays):
    """Texels, bottom row first."""

    texels: np.ndarray = array("uint8|float16 H W 4")
    repeat: bool = True  # else texture coordinates are clamped
    encoding: Encoding = Encoding.SRGB
    #: Whether colours count as much as their alpha where texels are averaged: they are not multiplied by it yet.
    straight_alpha: bool = False
    scale: float = 1.0  # of floats: what colours are multiplied by, as texels cannot be larger than 65504

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.texels.dtype != self.encoding.dtype:
            raise ValueError(f"texels of {self.texels.dtype} are not encoded as {self.encoding}")
