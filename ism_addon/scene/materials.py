# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials."""

from dataclasses import dataclass

import numpy as np

from .arrays import Arrays, array, index
from .limits import MAX_DISTANCE


@dataclass(frozen=True, eq=False)
class Materials(Arrays):
    """Lambertian materials: a base color, or an image in its place."""

    base_color: np.ndarray = array("float32 M 3", most=MAX_DISTANCE)
    #: -1: none.
    image: np.ndarray = index("int32 M", into="images", first=-1)
