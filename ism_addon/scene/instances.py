# SPDX-License-Identifier: GPL-3.0-or-later
"""Where meshes stand, and the groups that lights may be linked to."""

from dataclasses import dataclass

import numpy as np

from .arrays import Arrays, array, index
from .limits import MAX_DISTANCE

#: Groups of instances that lights may be linked to: bits of an instance's `groups`.
MAX_LINK_GROUPS = 32


@dataclass(frozen=True, eq=False)
class Instances(Arrays):
    """Where meshes stand. Rows of one mesh need not be neighbours."""

    mesh: np.ndarray = index("int32 I", into="meshes")
    world_from_object: np.ndarray = array("float64 I 4 4", "m", most=MAX_DISTANCE)
    #: Seen by the camera.
    visible: np.ndarray = array("bool I")
    casts_shadow: np.ndarray = array("bool I")
    #: Bit k: whether it belongs to group k.
    groups: np.ndarray = array("uint32 I")
