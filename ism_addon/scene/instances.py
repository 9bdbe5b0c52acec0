# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances of meshes, and their groups for light linking."""

from dataclasses import dataclass

import numpy as np

from .arrays import Arrays, array, index, optional_array
from .limits import MAX_DISTANCE

#: Maximum number of groups for light linking: each is a bit of an instance's `groups`.
MAX_LINK_GROUPS = 32


@dataclass(frozen=True, eq=False)
class Instances(Arrays):
    """Instances of meshes, in any order."""

    mesh: np.ndarray = index("int32 I", into="meshes")
    world_from_object: np.ndarray = array("float64 I 4 4", "m", max_abs=MAX_DISTANCE)
    #: Whether the camera sees it.
    visible: np.ndarray = array("bool I")
    casts_shadow: np.ndarray = array("bool I")
    #: Bit k is set if the instance belongs to group k.
    groups: np.ndarray = array("uint32 I")
    #: Whether surfaces receive the light that it emits.
    visible_diffuse: np.ndarray = array("bool I")
    #: Groups of the instances that receive this light, and that cast its shadows; -1: all.
    receivers: np.ndarray = index("int32 I", into=MAX_LINK_GROUPS, first=-1)
    blockers: np.ndarray = index("int32 I", into=MAX_LINK_GROUPS, first=-1)
    #: For graphs that read them, else without rows: what artists set for each object, and a number in 0 … 1.
    color: np.ndarray = optional_array("float32 O 4")
    pass_index: np.ndarray = optional_array("int32 O")
    random: np.ndarray = optional_array("float32 O")
    #: Likewise what graphs read by the operation "instance_attribute", whose parameter is the second index.
    attributes: np.ndarray = optional_array("float32 P A 4")
