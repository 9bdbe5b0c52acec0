# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes on whole numbers, which the camera and shadow rays see alike: each about the middle of its box, in steps.

A step is as fine as float32 tells apart at the farthest corner. What is closer to the middle gains nothing by more: a
ray's own rounding is as large everywhere.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...scene import Mesh, bounding_boxes
from .bvh import GRID_EXTENT

#: Vertices at a time: so many stay in a processor's cache.
VERTICES_AT_A_TIME = 1 << 15


@dataclass(frozen=True)
class Quantization:
    """Where a mesh's steps are."""

    centre: np.ndarray  # (3,) float64 object space, m
    quanta_per_metre: float  # steps a metre

    @classmethod
    def of(cls, mesh: Mesh) -> "Quantization":
        """That which just holds the mesh."""
        (centre,), (quanta_per_metre,) = quantizations((mesh,))
        return cls(centre, quanta_per_metre)

    def quantize(self, positions: np.ndarray, dtype: type = np.int32) -> np.ndarray:
        """(3,V) whole numbers, which float32 holds too, of positions (V,3)."""
        quanta: np.ndarray = np.empty((3, len(positions)), dtype)
        for first in range(0, len(positions), VERTICES_AT_A_TIME):
            part = slice(first, first + VERTICES_AT_A_TIME)
            quanta[:, part] = quantize(positions[part], self.centre, self.quanta_per_metre)
        return quanta


def quantizations(meshes: Sequence[Mesh]) -> tuple[np.ndarray, np.ndarray]:
    """Centres (M,3) and quanta_per_metre (M,) of those which just hold the meshes."""
    low, high = bounding_boxes(meshes).swapaxes(0, 1)
    return (low + high) / 2.0, GRID_EXTENT / np.maximum((high - low).max(1, initial=0.0) / 2.0, 1e-20)


def quantize(positions: np.ndarray, centre: np.ndarray, quanta_per_metre: np.ndarray | float) -> np.ndarray:
    """(3,V) float64 whole numbers, by centres (3,) or (V,3) and quanta per metre, one or (V,)."""
    return np.rint((positions - centre).T * quanta_per_metre)
