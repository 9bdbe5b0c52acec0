# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes on whole numbers, which the camera and shadow rays see alike: each about the middle of its box, in steps.

A step is as fine as float32 tells apart at the farthest corner. What is closer to the middle gains nothing by more: a
ray's own rounding is as large everywhere.
"""

from dataclasses import dataclass

import numpy as np

from ..scene import Mesh
from .tree import REACH

#: Vertices at a time: so many stay in a processor's cache.
PORTION = 1 << 15


@dataclass(frozen=True)
class Lattice:
    """Where a mesh's steps are."""

    centre: np.ndarray  # (3,) float64 object space, m
    scale: float  # steps a metre

    @classmethod
    def of(cls, mesh: Mesh) -> "Lattice":
        """That which just holds the mesh."""
        low, high = mesh.box
        return cls((low + high) / 2.0, REACH / max((high - low).max() / 2.0, 1e-20))

    def steps(self, positions: np.ndarray, dtype: type = np.int32) -> np.ndarray:
        """(3,V) whole numbers, which float32 holds too, of positions (V,3)."""
        found = np.empty((3, len(positions)), dtype)
        for first in range(0, len(positions), PORTION):
            part = slice(first, first + PORTION)
            found[:, part] = np.rint((positions[part] - self.centre).T * self.scale)
        return found
