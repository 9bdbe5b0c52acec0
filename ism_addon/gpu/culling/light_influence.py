# SPDX-License-Identifier: GPL-3.0-or-later
"""How much a light can do in each tile of the picture."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

#: A light that may bring at least this part of a tile's light is probed there in any case.
STRONG_FRACTION = 0.1

#: Visibility of a light where rays have not told yet: none was sent, or those sent were few.
UNKNOWN_VISIBILITY = 0.25


@dataclass(frozen=True)
class LightInfluence:
    """Of one light, in each tile: arrays (rows,columns). Bounds are upper bounds of its irradiance there."""

    contributes: np.ndarray  # bool: whether it counts at all
    bound_over_faint: np.ndarray  # float32: bound over the faint-light threshold, clamped to 1
    relative_bound: np.ndarray  # float32: bound over the tile's light or the picture's mean, clamped to 1
    bound_over_mean: np.ndarray  # float32: bound over the picture's mean, clamped to MAX_BOUND_OVER_MEAN
    coarse_visibility: np.ndarray  # float32: visibility about the tile, by few rays

    @cached_property
    def is_faint(self) -> np.ndarray:
        """(rows,columns) bool: whether it brings so little that pixels need no prediction of their own."""
        return self.contributes & (self.bound_over_faint < 1.0)

    @property
    def to_probe(self) -> np.ndarray:
        """(rows,columns) bool: whether ProbeVisibility sends rays."""
        strong = (self.relative_bound >= STRONG_FRACTION) | (self.coarse_visibility > 0.0)
        return self.contributes & ~self.is_faint & strong

    def visibility_with(self, rediscovered: np.ndarray | None) -> np.ndarray:
        """(rows,columns) coarse visibility, if retests have found the light in some tiles (rows,columns) bool."""
        if rediscovered is None:
            return self.coarse_visibility
        return np.where(rediscovered, np.maximum(self.coarse_visibility, UNKNOWN_VISIBILITY), self.coarse_visibility)


def visibilities(
    influences: Mapping[int, LightInfluence], rediscovered: Mapping[int, np.ndarray]
) -> dict[int, np.ndarray]:
    """(rows,columns) by light, with those that retests have found since the influences were estimated."""
    return {light: influence.visibility_with(rediscovered.get(light)) for light, influence in influences.items()}
