# SPDX-License-Identifier: GPL-3.0-or-later
"""The world: light from all directions, and the background."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from .arrays import Arrays, array, index
from .limits import MAX_EMISSION


@dataclass(frozen=True, eq=False)
class World(Arrays):
    """Radiance from all directions. What lights surfaces may differ from what the camera sees."""

    #: Of the light and of the background; of a graph about its mean.
    radiance: np.ndarray = array("float32 3", "W/(sr m²)", max_abs=MAX_EMISSION)
    background: np.ndarray = array("float32 3", "W/(sr m²)", max_abs=MAX_EMISSION)
    #: Of the light and of the background: the graph that gives the radiance, or -1; and the first of its constants.
    graph: np.ndarray = index("int32 2", into="graphs", first=-1)
    first_constant: np.ndarray = array("int32 2")
    constants: np.ndarray = array("float32 K 4")

    @classmethod
    def even(cls, radiance: np.ndarray) -> Self:
        """Of the same radiance (3,) in all directions."""
        none = {"graph": [-1, -1], "first_constant": [0, 0], "constants": np.zeros((0, 4))}
        return cls.of(radiance=radiance, background=radiance, **none)
