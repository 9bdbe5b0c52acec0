# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known of the lights after some samples, and how much each can contribute to each tile."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..tiles import repeated
from .hidden_lights import COARSE_SIDE, HiddenLights, over_coarse_tiles
from .light_influence import LightInfluence
from .surface_bounds import SurfaceBounds

# How these were chosen: `dev.py bench constants`, see docs/benchmarks.md.

#: The culled lights of a tile together contribute at most this fraction of its irradiance.
MAX_CULLED_FRACTION = 1e-3

#: For culling, a tile's irradiance counts as at least this fraction of the picture's mean.
MIN_RELATIVE_IRRADIANCE = 0.1

#: A light is faint in a tile if its bound is at most this fraction of the tile's irradiance. It has one prediction per
#: tile.
FAINT_FRACTION = 0.01

#: Bounds are clamped to this multiple of the picture's mean irradiance.
MAX_BOUND_OVER_MEAN = 100.0

FLOAT32_TINY = float(np.finfo(np.float32).tiny)


@dataclass
class CullingState:
    """Bounds and visibility of lights, from all samples so far. Irradiance is a luminance, W/m²."""

    surfaces: SurfaceBounds  # of the visible surfaces of each tile
    lights: np.ndarray  # (K,) indices of those that are bounded in each tile
    bounds: np.ndarray  # (K,rows,columns) float32: upper bounds of their irradiance
    hidden: HiddenLights
    coarse_visibility: dict[int, np.ndarray]  # (rows,columns) by light, of those that are bounded anywhere
    irradiance: np.ndarray  # (rows,columns): estimated sum over all lights

    @cached_property
    def exists(self) -> np.ndarray:
        """(rows,columns) bool: whether there are surfaces."""
        near_and_far = self.surfaces.exists.reshape(2, *self.irradiance.shape)
        return near_and_far[0] | near_and_far[1]

    @cached_property
    def mean(self) -> float:
        """Of the irradiance."""
        return max(float(self.irradiance[self.exists].mean()) if self.exists.any() else 0.0, FLOAT32_TINY)

    @cached_property
    def tile_irradiance(self) -> np.ndarray:
        """(rows,columns): the tile's irradiance or the picture's mean, if that is more."""
        return np.maximum(self.irradiance, self.mean)

    @cached_property
    def hidden_bound(self) -> np.ndarray:
        """(rows,columns): bounds of all hidden lights together, or `tile_irradiance`, if that is more.

        Of many lights that are hidden, one is a small part: together they are probed and retested as if they were one.
        """
        return np.maximum(self.hidden_sum(np.inf), self.tile_irradiance)

    @cached_property
    def limited_hidden_bound(self) -> np.ndarray:
        """(rows,columns): the same if no light that is bounded in the tile counts more than `tile_irradiance`."""
        return np.maximum(self.hidden_sum(self.tile_irradiance), self.tile_irradiance)

    def hidden_sum(self, limit: np.ndarray | float) -> np.ndarray:
        """(rows,columns): sum of the bounds of all hidden lights; in each tile up to a limit each, if bounded there."""
        rows, columns = self.irradiance.shape
        total = repeated(self.hidden.bounds.sum(0), COARSE_SIDE, (columns, rows))
        for light, bound in zip(self.lights.tolist(), self.bounds, strict=True):
            if light in self.coarse_visibility:
                total = total + np.minimum(bound, limit) * (self.coarse_visibility[light] == 0.0)
        return total

    def relative_bound(self, bound: np.ndarray) -> np.ndarray:
        """(rows,columns): a hidden light's bound in each tile over those of all hidden lights, up to 1.

        A single light close by, which may be covered, does not make all others small: the ratio is the larger one of
        all bounds and of limited ones.
        """
        limited = np.minimum(bound, self.tile_irradiance) / self.limited_hidden_bound
        return np.maximum(np.minimum(bound / self.hidden_bound, 1.0), limited)

    def relative_bounds(self, function: np.ufunc) -> np.ndarray:
        """(H,R,C): bounds of hidden lights over those of all, reduced over each coarse tile."""
        relative: np.ndarray = self.hidden.bounds * over_coarse_tiles(function, self.exists / self.hidden_bound)
        return relative


def light_influences(state: CullingState, has_gloss: bool) -> dict[int, LightInfluence]:
    """By light, its influence on the tiles, for all lights that contribute to any tile.

    With gloss, no light is negligible: the reflection of a small one is bright, however little its irradiance is.
    """
    influences, mean, culled = {}, state.mean, np.zeros_like(state.irradiance)
    local = np.maximum(state.irradiance, MIN_RELATIVE_IRRADIANCE * mean)
    bounds = with_edges(state.bounds, state.exists)
    for row in np.argsort(np.tensordot(bounds, 1.0 / state.tile_irradiance)):  # faintest first
        light, bound = int(state.lights[row]), bounds[row]
        culled += bound
        contributes = (bound > 0.0) & (has_gloss | (culled > MAX_CULLED_FRACTION * local))
        if contributes.any():
            visibility = state.coarse_visibility.get(light, np.zeros_like(bound))
            influences[light] = LightInfluence(
                contributes=contributes,
                bound_over_faint=np.minimum(bound / np.maximum(FAINT_FRACTION * local, FLOAT32_TINY), 1.0),
                relative_bound=np.where(
                    visibility == 0.0, state.relative_bound(bound), np.minimum(bound / state.tile_irradiance, 1.0)
                ),
                bound_over_mean=np.minimum(bound, MAX_BOUND_OVER_MEAN * mean) / mean,
                coarse_visibility=visibility,
            )
    return influences


def with_edges(bounds: np.ndarray, exists: np.ndarray) -> np.ndarray:
    """Bounds (L,rows,columns); in tiles without surfaces, the greatest of their neighbours.

    In a later sample the edge of a neighbour's surface may be in such a tile.
    """
    row, column = np.nonzero(neighbourhood(exists).any((2, 3)) & ~exists)
    if not len(row):
        return bounds
    rows, columns = (
        np.clip(index + np.arange(-1, 2)[:, None], 0, size - 1)
        for index, size in zip((row, column), exists.shape, strict=True)
    )
    filled = bounds.copy()
    filled[:, row, column] = np.max([bounds[:, y, x] for y in rows for x in columns], 0)
    return filled


def neighbourhood(values: np.ndarray) -> np.ndarray:
    """(H,W,3,3): 3×3 neighbourhoods of (H,W). Values at the border are repeated beyond it."""
    return np.lib.stride_tricks.sliding_window_view(np.pad(values, 1, mode="edge"), (3, 3))
