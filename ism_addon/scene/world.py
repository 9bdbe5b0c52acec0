# SPDX-License-Identifier: GPL-3.0-or-later
"""The world's light."""

from dataclasses import dataclass

import numpy as np

from .arrays import Arrays, array
from .limits import MAX_DISTANCE


@dataclass(frozen=True, eq=False)
class World(Arrays):
    """The constant environment light, also the background."""

    radiance: np.ndarray = array("float32 3", "W/(sr m²)", max_abs=MAX_DISTANCE)
