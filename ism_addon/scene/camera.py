# SPDX-License-Identifier: GPL-3.0-or-later
"""What takes the picture."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from .arrays import Arrays, array
from .limits import MAX_DISTANCE

#: A picture's width and height, as in Blender.
MAX_PIXELS = 1 << 16


@dataclass(frozen=True, eq=False)
class View(Arrays):
    """A camera and the picture it takes."""

    #: OpenGL's clip space.
    clip_from_view: np.ndarray = array("float64 4 4", most=4.0 * MAX_DISTANCE)
    #: Rigid; the view looks along -z.
    view_from_world: np.ndarray = array("float64 4 4", "m", most=4.0 * MAX_DISTANCE)
    width: int  # type: ignore[misc] # px; mypy takes array() for a default
    height: int  # type: ignore[misc] # px
    filter_width: float = 1.5  # px that the Blackman-Harris pixel filter reaches to all sides
    transparent: bool = False  # leave the background empty instead of showing the world

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (1 <= self.width <= MAX_PIXELS and 1 <= self.height <= MAX_PIXELS):
            raise ValueError(f"a picture of {self.width}×{self.height} pixels cannot be drawn")

    def coarse(self, pixel: int) -> Self:
        """The same in pixels that are `pixel` of these wide and high, as far as they divide them."""
        return replace(self, width=max(self.width // pixel, 1), height=max(self.height // pixel, 1))
