# SPDX-License-Identifier: GPL-3.0-or-later
"""How much a light can contribute to each tile."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

#: A light whose bound is at least this fraction of a tile's light is probed there, even if coarse rays were occluded.
STRONG_FRACTION = 0.1

#: Coarse visibility of a light where too few rays were traced to estimate it. For both constants see `dev.py bench
#: constants` in docs/benchmarks.md.
UNKNOWN_VISIBILITY = 0.25


@dataclass(frozen=True)
class LightInfluence:
    """Arrays (rows,columns) over the tiles, for one light. Bounds are upper bounds of its irradiance."""

    contributes: np.ndarray  # bool: whether it is not culled
    bound_over_faint: np.ndarray  # float32: bound over the faint-light threshold, clamped to 1
    #: float32: bound over the tile's light or the picture's mean, clamped to 1; of lights that no coarse ray reaches,
    #: over the bounds of all of these, if they are more.
    relative_bound: np.ndarray
    bound_over_mean: np.ndarray  # float32: bound over the picture's mean, clamped to MAX_BOUND_OVER_MEAN
    coarse_visibility: np.ndarray  # float32: estimate from few rays around the tile

    @cached_property
    def is_faint(self) -> np.ndarray:
        """(rows,columns) bool: whether one prediction for the tile is enough."""
        return self.contributes & (self.bound_over_faint < 1.0)

    @property
    def to_probe(self) -> np.ndarray:
        """(rows,columns) bool: whether ProbeVisibility traces rays."""
        strong = (self.relative_bound >= STRONG_FRACTION) | (self.coarse_visibility > 0.0)
        return self.contributes & ~self.is_faint & strong

    def visibility_with(self, rediscovered: np.ndarray | None) -> np.ndarray:
        """(rows,columns) coarse visibility, raised in `rediscovered` tiles (rows,columns) bool."""
        if rediscovered is None:
            return self.coarse_visibility
        return np.where(rediscovered, np.maximum(self.coarse_visibility, UNKNOWN_VISIBILITY), self.coarse_visibility)


def visibilities(
    influences: Mapping[int, LightInfluence], rediscovered: Mapping[int, np.ndarray]
) -> dict[int, np.ndarray]:
    """Coarse visibility (rows,columns) by light, raised where later retests were unoccluded."""
    return {light: influence.visibility_with(rediscovered.get(light)) for light, influence in influences.items()}
