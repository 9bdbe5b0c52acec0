# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantization of meshes to integers relative to the centre of their box, for the visibility buffer and shadow rays.

A quantum is the precision of float32 at the box's farthest corner. A higher precision near the centre would not help,
because a ray's rounding error is as large everywhere.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...scene import Mesh, bounding_boxes
from .bvh import GRID_EXTENT

#: Vertices that are quantized at a time, so that they stay in the processor's cache.
VERTICES_AT_A_TIME = 1 << 15


@dataclass(frozen=True)
class Quantization:
    """The grid of quanta to which a mesh is rounded."""

    centre: np.ndarray  # (3,) float64 object space, m
    quanta_per_metre: float

    @classmethod
    def of(cls, mesh: Mesh) -> "Quantization":
        """The finest grid that contains the mesh."""
        (centre,), (quanta_per_metre,) = quantizations((mesh,))
        return cls(centre, quanta_per_metre)

    def quantize(self, positions: np.ndarray, dtype: type = np.int32) -> np.ndarray:
        """(3,V) quanta, which float32 represents exactly, of positions (V,3)."""
        quanta: np.ndarray = np.empty((3, len(positions)), dtype)
        for first in range(0, len(positions), VERTICES_AT_A_TIME):
            chunk = slice(first, first + VERTICES_AT_A_TIME)
            quanta[:, chunk] = quantize(positions[chunk], self.centre, self.quanta_per_metre)
        return quanta


def quantizations(meshes: Sequence[Mesh]) -> tuple[np.ndarray, np.ndarray]:
    """Centres (M,3) and quanta_per_metre (M,) of the finest grids that contain the meshes."""
    low, high = bounding_boxes(meshes).swapaxes(0, 1)
    return (low + high) / 2.0, GRID_EXTENT / np.maximum((high - low).max(1, initial=0.0) / 2.0, 1e-20)


def quantize(positions: np.ndarray, centre: np.ndarray, quanta_per_metre: np.ndarray | float) -> np.ndarray:
    """(3,V) quanta as float64, of positions (V,3); centres are (3,) or (V,3), quanta_per_metre is a number or (V,)."""
    return np.rint((positions - centre).T * quanta_per_metre)
