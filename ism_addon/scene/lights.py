# SPDX-License-Identifier: GPL-3.0-or-later
"""Area lights."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Self

import numpy as np

from .arrays import UNIT_VECTOR, Arrays, array, array_specs, index
from .instances import MAX_LINK_GROUPS
from .limits import MAX_DISTANCE, MAX_RADIANCE


class LightShape(IntEnum):
    """Blender's squares are rectangles, and its disks ellipses."""

    RECTANGLE = 0
    ELLIPSE = 1


@dataclass(frozen=True, eq=False)
class Lights(Arrays):
    """One-sided Lambertian area lights in world space. The axes are full width and height, scale included."""

    #: LightShape.
    shape: np.ndarray = index("int32 L", into=len(LightShape))
    position: np.ndarray = array("float64 L 3", "m", max_abs=MAX_DISTANCE)
    axis_u: np.ndarray = array("float64 L 3", "m", max_abs=MAX_DISTANCE)
    axis_v: np.ndarray = array("float64 L 3", "m", max_abs=MAX_DISTANCE)
    #: On the side that emits.
    normal: np.ndarray = array("float64 L 3", UNIT_VECTOR)
    #: In the direction of the normal.
    radiance: np.ndarray = array("float32 L 3", "W/(sr m²)", max_abs=MAX_RADIANCE)
    #: Blender's spread; pi: Lambertian.
    spread: np.ndarray = array("float32 L", "rad")
    casts_shadow: np.ndarray = array("bool L")
    #: Group of the instances that receive the light; -1: all instances.
    receivers: np.ndarray = index("int32 L", into=MAX_LINK_GROUPS, first=-1)
    #: Group of the instances that cast shadows from the light; -1: all instances.
    blockers: np.ndarray = index("int32 L", into=MAX_LINK_GROUPS, first=-1)

    def select(self, rows: np.ndarray | slice) -> Self:
        """The lights in these rows."""
        return type(self)(**{name: getattr(self, name)[rows] for name in array_specs(type(self))})
