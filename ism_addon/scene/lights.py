# SPDX-License-Identifier: GPL-3.0-or-later
"""Area lights."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from .arrays import UNIT_VECTOR, Arrays, array, index
from .instances import MAX_LINK_GROUPS
from .limits import MAX_DISTANCE, MAX_RADIANCE


class LightShape(IntEnum):
    """Blender's four area lights are two: a square is a rectangle, a disk an ellipse."""

    RECTANGLE = 0
    ELLIPSE = 1


@dataclass(frozen=True, eq=False)
class Lights(Arrays):
    """One-sided Lambertian area lights in world space. The axes are full width and height, scale included."""

    #: LightShape.
    shape: np.ndarray = index("int32 L", into=len(LightShape))
    position: np.ndarray = array("float64 L 3", "m", most=MAX_DISTANCE)
    axis_u: np.ndarray = array("float64 L 3", "m", most=MAX_DISTANCE)
    axis_v: np.ndarray = array("float64 L 3", "m", most=MAX_DISTANCE)
    #: The side that shines.
    normal: np.ndarray = array("float64 L 3", UNIT_VECTOR)
    #: Towards the normal.
    radiance: np.ndarray = array("float32 L 3", "W/(sr m²)", most=MAX_RADIANCE)
    #: Blender's spread: pi is a plain Lambertian light.
    spread: np.ndarray = array("float32 L", "rad")
    casts_shadow: np.ndarray = array("bool L")
    #: The group of instances that it lights; -1: all.
    receivers: np.ndarray = index("int32 L", into=MAX_LINK_GROUPS, first=-1)
    #: The group of instances that casts its shadows; -1: all.
    blockers: np.ndarray = index("int32 L", into=MAX_LINK_GROUPS, first=-1)
