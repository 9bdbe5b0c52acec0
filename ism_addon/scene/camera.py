# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera's view."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from .arrays import Arrays, array
from .limits import MAX_DISTANCE

#: Limit of an image's width and of its height, as in Blender.
MAX_PIXELS = 1 << 16


@dataclass(frozen=True, eq=False)
class View(Arrays):
    """A camera, and the size and filter of its image."""

    #: OpenGL's clip space.
    clip_from_view: np.ndarray = array("float64 4 4", max_abs=4.0 * MAX_DISTANCE)
    #: Rigid; the view looks along -z.
    view_from_world: np.ndarray = array("float64 4 4", "m", max_abs=4.0 * MAX_DISTANCE)
    width: int  # type: ignore[misc] # px; mypy takes array() for a default
    height: int  # type: ignore[misc] # px
    filter_width: float = 1.5  # radius of the Blackman-Harris pixel filter, px
    transparent: bool = False  # leave the background empty instead of showing the world

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (1 <= self.width <= MAX_PIXELS and 1 <= self.height <= MAX_PIXELS):
            raise ValueError(f"a picture of {self.width}×{self.height} pixels cannot be drawn")

    def with_larger_pixels(self, factor: int) -> Self:
        """The same view with pixels `factor` times as wide and high, rounded down."""
        return replace(self, width=max(self.width // factor, 1), height=max(self.height // factor, 1))
